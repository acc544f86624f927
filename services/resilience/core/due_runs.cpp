#include "services/resilience/core/due_runs.hpp"

namespace trb::resilience {

void DueRuns::schedule(const std::string& run, std::optional<MonotonicTime> at) {
  if (const auto known = moments_.find(run); known != moments_.end()) {
    by_time_.erase({known->second, run});
    moments_.erase(known);
  }
  if (!at) return;
  moments_[run] = *at;
  by_time_.emplace(*at, run);
}

void DueRuns::hasten(const std::string& run, std::optional<MonotonicTime> at) {
  const auto known = moments_.find(run);
  if (at && (known == moments_.end() || *at < known->second)) schedule(run, at);
}

std::set<std::string> DueRuns::take(MonotonicTime now) {
  std::set<std::string> out = std::exchange(notified_, {});
  while (!by_time_.empty() && by_time_.begin()->first <= now) {
    const std::string run = by_time_.begin()->second;
    schedule(run, std::nullopt);
    out.insert(run);
  }
  for (const std::string& run : out) schedule(run, std::nullopt);
  return out;
}

std::optional<MonotonicTime> DueRuns::next() const {
  return by_time_.empty() ? std::nullopt : std::optional(by_time_.begin()->first);
}

}  // namespace trb::resilience
