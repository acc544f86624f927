#include "services/scheduler/core/duties.hpp"

#include <algorithm>

namespace trb::scheduler {

bool BackOff::slow() const {
  return wait_ >= seconds(0.8);
}

void BackOff::sent(MonotonicTime now) {
  next_ = now + wait_;
  wait_ = std::min(wait_ * 2, seconds(2));
}

bool Pace::due(MonotonicTime now) {
  if (!next_) {
    next_ = now + wait_;
    return false;
  }
  if (*next_ > now) return false;
  wait_ = std::min<Duration>(wait_ * 2, kLongest);
  next_ = now + wait_;
  return true;
}

void Duties::owe(DutyKind kind, const std::string& to, const std::vector<TaskIndex>& tasks) {
  const bool owed = std::any_of(open_.begin(), open_.end(), [&](const Duty& duty) {
    return duty.kind == kind && duty.to == to && duty.tasks == tasks;
  });
  if (owed) return;
  open_.push_back({kind, to, tasks, {}});
  ++changes_;
}

template <class Match>
bool Duties::remove(const Match& match) {
  const bool any = std::erase_if(open_, match) > 0;
  changes_ += any ? 1 : 0;
  return any;
}

bool Duties::settle_one(DutyKind kind, const std::string& to, const std::vector<TaskIndex>& tasks) {
  return remove([&](const Duty& duty) { return duty.kind == kind && duty.to == to && duty.tasks == tasks; });
}

bool Duties::settle(DutyKind kind, const std::string& to, const std::vector<TaskIndex>& tasks) {
  if (kind != DutyKind::results) return settle_one(kind, to, tasks);
  bool any = false;
  for (const TaskIndex task : tasks) any = settle_one(kind, to, {task}) || any;
  return any;
}

void Duties::drop(DutyKind kind) {
  remove([&](const Duty& duty) { return duty.kind == kind; });
}

void Duties::drop(DutyKind kind, const std::string& to) {
  remove([&](const Duty& duty) { return duty.kind == kind && duty.to == to; });
}

void Duties::drop_batons() {
  remove([](const Duty& duty) { return duty.kind == DutyKind::baton && !duty.tasks.empty(); });
}

Duty Duties::gather_results(const std::string& to, MonotonicTime now) {
  Duty all{DutyKind::results, to, {}, {}};
  for (Duty& duty : open_) {
    const bool taken = duty.kind == DutyKind::results && duty.to == to && (duty.timer.due(now) || duty.timer.slow());
    if (!taken) continue;
    all.tasks.insert(all.tasks.end(), duty.tasks.begin(), duty.tasks.end());
    duty.timer.sent(now);
  }
  return all;
}

std::vector<Duty> Duties::take_due(MonotonicTime now) {
  std::vector<Duty> out;
  for (Duty& duty : open_) {
    if (!duty.timer.due(now)) continue;
    if (duty.kind == DutyKind::results) {
      out.push_back(gather_results(duty.to, now));
    } else {
      duty.timer.sent(now);
      out.push_back(duty);
    }
  }
  return out;
}

void Duties::restart() {
  for (Duty& duty : open_) duty.timer.restart();
}

std::optional<MonotonicTime> Duties::next() const {
  std::optional<MonotonicTime> out;
  for (const Duty& duty : open_) out = earlier(out, duty.timer.next());
  return out;
}

bool Duties::owes(DutyKind kind, const std::string& to) const {
  return std::any_of(open_.begin(), open_.end(), [&](const Duty& duty) { return duty.kind == kind && duty.to == to; });
}

bool Duties::owes_baton(TaskIndex task) const {
  return std::any_of(open_.begin(), open_.end(), [&](const Duty& duty) {
    return duty.kind == DutyKind::baton && std::find(duty.tasks.begin(), duty.tasks.end(), task) != duty.tasks.end();
  });
}

std::vector<std::string> Duties::creditors(DutyKind kind) const {
  std::vector<std::string> out;
  for (const Duty& duty : open_) {
    if (duty.kind == kind && std::find(out.begin(), out.end(), duty.to) == out.end()) out.push_back(duty.to);
  }
  return out;
}

}  // namespace trb::scheduler
