#include "services/scheduler/core/run/pending_deliveries.hpp"

#include <algorithm>

namespace trb::scheduler {

bool Pace::due(MonotonicTime now) {
  if (next_ && *next_ > now) return false;
  const bool has_begun = next_.has_value();
  next_ = now + back_off_.next();
  return has_begun;
}

void PendingDeliveries::owe(DeliveryKind kind, const std::string& to, const std::vector<TaskIndex>& tasks) {
  const bool owed = std::any_of(open_.begin(), open_.end(), [&](const PendingDelivery& delivery) {
    return delivery.kind == kind && delivery.to == to && delivery.tasks == tasks;
  });
  if (owed) return;
  open_.push_back({kind, to, tasks});
  ++changes_;
}

template <class Match>
bool PendingDeliveries::remove(const Match& match) {
  const bool any = std::erase_if(open_, match) > 0;
  changes_ += any ? 1 : 0;
  return any;
}

bool PendingDeliveries::settle_one(DeliveryKind kind, const std::string& to, const std::vector<TaskIndex>& tasks) {
  return remove([&](const PendingDelivery& delivery) {
    return delivery.kind == kind && delivery.to == to && delivery.tasks == tasks;
  });
}

bool PendingDeliveries::settle(DeliveryKind kind, const std::string& to, const std::vector<TaskIndex>& tasks) {
  if (kind != DeliveryKind::results) return settle_one(kind, to, tasks);
  bool any = false;
  for (const TaskIndex task : tasks) any = settle_one(kind, to, {task}) || any;
  return any;
}

void PendingDeliveries::drop(DeliveryKind kind) {
  remove([&](const PendingDelivery& delivery) { return delivery.kind == kind; });
}

void PendingDeliveries::drop(DeliveryKind kind, const std::string& to) {
  remove([&](const PendingDelivery& delivery) { return delivery.kind == kind && delivery.to == to; });
}

void PendingDeliveries::drop_batons() {
  remove(
      [](const PendingDelivery& delivery) { return delivery.kind == DeliveryKind::baton && !delivery.tasks.empty(); });
}

PendingDelivery PendingDeliveries::gather_results(const std::string& to, MonotonicTime now) {
  PendingDelivery all{DeliveryKind::results, to, {}};
  for (PendingDelivery& delivery : open_) {
    const bool taken = delivery.kind == DeliveryKind::results && delivery.to == to &&
                       (delivery.timer.is_due(now) || is_slow(delivery.timer));
    if (!taken) continue;
    all.tasks.insert(all.tasks.end(), delivery.tasks.begin(), delivery.tasks.end());
    all.is_again = all.is_again || delivery.timer.times() > 0;
    delivery.timer.on_sent(now);
  }
  return all;
}

std::vector<PendingDelivery> PendingDeliveries::take_due(MonotonicTime now) {
  std::vector<PendingDelivery> out;
  for (PendingDelivery& delivery : open_) {
    if (!delivery.timer.is_due(now)) continue;
    if (delivery.kind == DeliveryKind::results) {
      out.push_back(gather_results(delivery.to, now));
    } else {
      out.push_back(delivery);
      out.back().is_again = delivery.timer.times() > 0;
      delivery.timer.on_sent(now);
    }
  }
  return out;
}

void PendingDeliveries::restart() {
  for (PendingDelivery& delivery : open_) delivery.timer.restart();
}

std::optional<MonotonicTime> PendingDeliveries::next() const {
  std::optional<MonotonicTime> out;
  for (const PendingDelivery& delivery : open_) out = earlier(out, delivery.timer.due_at());
  return out;
}

bool PendingDeliveries::owes(DeliveryKind kind, const std::string& to) const {
  return std::any_of(open_.begin(), open_.end(),
                     [&](const PendingDelivery& delivery) { return delivery.kind == kind && delivery.to == to; });
}

bool PendingDeliveries::owes_baton(TaskIndex task) const {
  return std::any_of(open_.begin(), open_.end(), [&](const PendingDelivery& delivery) {
    return delivery.kind == DeliveryKind::baton &&
           std::find(delivery.tasks.begin(), delivery.tasks.end(), task) != delivery.tasks.end();
  });
}

std::vector<PendingDelivery> PendingDeliveries::owed_to(const std::string& node) const {
  std::vector<PendingDelivery> out;
  for (const PendingDelivery& delivery : open_) {
    if (delivery.to == node) out.push_back(delivery);
  }
  return out;
}

std::vector<std::string> PendingDeliveries::creditors(DeliveryKind kind) const {
  std::vector<std::string> out;
  for (const PendingDelivery& delivery : open_) {
    if (delivery.kind == kind && std::find(out.begin(), out.end(), delivery.to) == out.end())
      out.push_back(delivery.to);
  }
  return out;
}

}  // namespace trb::scheduler
