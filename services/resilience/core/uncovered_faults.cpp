#include "services/resilience/core/uncovered_faults.hpp"

namespace trb::resilience {

void UncoveredFaults::follow(const Fleet& fleet, Now now) {
  if (seen_ == fleet.fault_changes()) return;
  seen_ = fleet.fault_changes();
  std::map<Key, MonotonicTime> stand;
  for (const auto& [id, robot] : fleet.robots()) {
    for (const Fault& fault : robot.faults) {
      if (!takes_away(fault)) continue;
      const Key key{id, fault.capability};
      const auto known = uncovered_since_.find(key);
      stand[key] = known == uncovered_since_.end() ? now.mono : known->second;
    }
  }
  uncovered_since_ = std::move(stand);
}

void UncoveredFaults::cover(const Key& fault, Now now) {
  if (const auto at = uncovered_since_.find(fault); at != uncovered_since_.end()) at->second = now.mono;
}

std::vector<UncoveredFaults::Key> UncoveredFaults::uncovered(Now now) const {
  std::vector<Key> out;
  for (const auto& [key, since] : uncovered_since_) {
    if (now.mono - since >= kSettle) out.push_back(key);
  }
  return out;
}

std::optional<MonotonicTime> UncoveredFaults::next(Now now) const {
  std::optional<MonotonicTime> out;
  for (const auto& [key, since] : uncovered_since_) {
    if (since + kSettle > now.mono) out = earlier(out, since + kSettle);
  }
  return out;
}

}  // namespace trb::resilience
