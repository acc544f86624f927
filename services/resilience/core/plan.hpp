// What a verdict comes to now: rulings that may be signed, or what is to happen before.
#pragma once

#include <string>
#include <vector>

#include "proto/bodies/resilience.hpp"
#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {

struct Plan {
  std::vector<TaskRuling> rulings;     ///< of use once waits_for is empty; none then: nothing is left to decide
  std::vector<std::uint16_t> release;  ///< tasks that the robot is to give back
  std::string waits_for;               ///< in words; empty: it may be signed
};

/// Of an alert with a verdict that is no abort: proposals.front() says who takes over; needs_word that a person has
/// said that the robot stands. `node`: who skips. `asked_long`: a robot that is reached has had its time to answer, and
/// the word counts without it. The run is_known().
Plan plan_of(const Alert& alert, const WatchedRun& run, const Fleet& fleet, const std::string& node, bool asked_long);

}  // namespace trb::resilience
