// How many tasks each robot still has, over all runs: the fewer, the more available it is.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "services/resilience/core/watched_run.hpp"

namespace trb::resilience {

class OpenTasks {
 public:
  /// Counts the run's tasks that are not final anew; nullptr or without a view: it has none. Returns the robots whose
  /// number may have changed.
  std::set<std::string> count(const std::string& run, const WatchedRun* is);
  /// The number over all runs.
  [[nodiscard]] std::uint32_t of(std::string_view robot) const;

 private:
  using ByRobot = std::map<std::string, std::uint32_t, std::less<>>;
  void add(const ByRobot& tasks);
  void subtract(const ByRobot& tasks);

  std::map<std::string, ByRobot, std::less<>> by_run_;
  ByRobot total_;
};

}  // namespace trb::resilience
