// Faults that stand (CRITICAL, FATAL), and since when no alert has covered them.
#pragma once

#include <compare>
#include <map>
#include <string>
#include <vector>

#include "services/resilience/core/fleet.hpp"

namespace trb::resilience {

class UncoveredFaults {
 public:
  /// For this long a run's alert may still come, or come again.
  static constexpr Duration kSettle = std::chrono::seconds(2);

  struct Key {
    std::string robot;
    std::string capability;  ///< empty: the whole robot
    auto operator<=>(const Key&) const = default;
  };

  /// Looks at the fleet's faults, if they have changed.
  void follow(const Fleet& fleet, Now now);
  /// An open alert covers it.
  void cover(const Key& fault, Now now);
  /// Those that no alert has covered for kSettle.
  [[nodiscard]] std::vector<Key> uncovered(Now now) const;
  [[nodiscard]] std::optional<MonotonicTime> next(Now now) const;

 private:
  std::map<Key, MonotonicTime> uncovered_since_;
  std::optional<std::uint64_t> seen_;  ///< Fleet::fault_changes
};

}  // namespace trb::resilience
