// What a verdict means now: rulings that may be signed, or what must happen first.
#pragma once

#include <string>
#include <vector>

#include "proto/bodies/resilience.hpp"
#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {

struct Plan {
  std::vector<TaskRuling> rulings;     ///< valid once waits_for is empty; none then: nothing is left to decide
  std::vector<std::uint16_t> release;  ///< tasks that the robot must give back
  std::string waits_for;               ///< for people; empty: it may be signed
};

/// For an alert with a verdict other than abort: proposals.front() names the robots that take over; needs_word means
/// that a person has stated that the robot stands. `node`: skips the tasks. `asked_long`: a reachable robot has had its
/// time to answer, and the statement counts without an answer. The run is_known().
Plan plan_of(const Alert& alert, const WatchedRun& run, const Fleet& fleet, const std::string& node, bool asked_long);

}  // namespace trb::resilience
