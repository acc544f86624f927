#include "services/scheduler/core/run/pending_requests.hpp"

namespace trb::scheduler {

void PendingRequests::drop_results_of(const std::string& giver) {
  for (const auto& [task, need] : results_) {
    if (need.giver == giver) none_.insert({giver, task});
  }
  std::erase_if(results_, [&](const auto& need) { return need.second.giver == giver; });
}

std::map<std::string, std::vector<TaskIndex>> PendingRequests::take_due_results(MonotonicTime now) {
  std::map<std::string, std::vector<TaskIndex>> out;
  for (auto& [task, need] : results_) {
    if (!need.timer.is_due(now)) continue;
    need.timer.on_sent(now);
    out[need.giver].push_back(task);
  }
  return out;
}

void PendingRequests::restart() {
  for (auto& [task, need] : results_) need.timer.restart();
}

std::optional<MonotonicTime> PendingRequests::next() const {
  std::optional<MonotonicTime> out = end_.next();
  for (const auto& [task, need] : results_) out = earlier(out, need.timer.due_at());
  return out;
}

}  // namespace trb::scheduler
