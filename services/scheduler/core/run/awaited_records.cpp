#include "services/scheduler/core/run/awaited_records.hpp"

#include <algorithm>
#include <utility>

namespace trb::scheduler {
namespace {

/// An answer may come so long after its request: each of the two is given up after 10 s on its way.
constexpr Duration kAnswerTime = std::chrono::seconds(30);

/// As often in vain takes 3 s.
constexpr unsigned kAskedInVain = 5;

}  // namespace

void AwaitedRecords::need_result(TaskIndex task, const std::string& giver, const std::string& judge) {
  const auto [at, is_new] = results_.try_emplace(task, Need{giver});
  Need& need = at->second;
  if (is_new || need.giver == giver || std::ranges::find(need.others, giver) != need.others.end()) return;
  need.others.insert(giver == judge ? need.others.begin() : need.others.end(), giver);
  if (giver == judge) ask_next(need, true);
}

/// `again`: the one that was asked until now will be asked once more, after the others.
void AwaitedRecords::ask_next(Need& need, bool again) {
  if (again) need.others.push_back(need.giver);
  Need next{need.others.front(), {need.others.begin() + 1, need.others.end()}};
  need = std::move(next);
}

void AwaitedRecords::settle(std::map<TaskIndex, Need>::iterator need) {
  answered_.insert({need->second.giver, need->first});
  if (!need->second.others.empty()) return ask_next(need->second, false);
  results_.erase(need);
}

void AwaitedRecords::settle_result(TaskIndex task, const std::string& giver) {
  const auto need = results_.find(task);
  if (need != results_.end() && need->second.giver == giver) settle(need);
}

void AwaitedRecords::settle_without_result(const std::string& giver, MonotonicTime now) {
  for (auto at = results_.begin(); at != results_.end();) {
    const auto need = at++;
    const auto& since = need->second.in_all_since;
    if (need->second.giver == giver && since && *since <= now) settle(need);
  }
}

std::map<std::string, std::vector<TaskIndex>> AwaitedRecords::take_due_results(MonotonicTime now) {
  std::set<std::string> due;
  for (auto& [task, need] : results_) {
    if (!need.timer.is_due(now)) continue;
    if (need.timer.times() >= kAskedInVain && !need.others.empty()) ask_next(need, true);
    due.insert(need.giver);
  }
  std::map<std::string, std::vector<TaskIndex>> out;
  for (auto& [task, need] : results_) {
    if (!due.contains(need.giver)) continue;
    const auto before = requested_.find(need.giver);
    if (!need.in_all_since) need.in_all_since = before == requested_.end() ? now : before->second + kAnswerTime;
    need.timer.on_sent(now);
    out[need.giver].push_back(task);
  }
  for (const std::string& giver : due) requested_[giver] = now;
  return out;
}

void AwaitedRecords::restart() {
  for (auto& [task, need] : results_) need.timer.restart();
}

std::optional<MonotonicTime> AwaitedRecords::next() const {
  std::optional<MonotonicTime> out = end_.next();
  for (const auto& [task, need] : results_) out = earlier(out, need.timer.due_at());
  return out;
}

}  // namespace trb::scheduler
