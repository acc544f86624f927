// A simulation's answer as played tasks, and their waits as JSON.
#pragma once

#include <vector>

#include "common/scenario/critical_path.hpp"
#include "common/scenario/definition.hpp"
#include "proto/value.hpp"

namespace trb {

/// The attempts in the answer's `tasks` that were done, and of each task that never was its last one that has failed
/// (`failed_s`), by begin; times count from the first one's. `after`: in place of a predecessor without such an
/// attempt (it was skipped) those before it. What is no task of the scenario is left out.
std::vector<PlayedTask> played_tasks(const Value& answer, const Scenario& scenario);

/// [{"task", "waited_for", "robot_busy", "critical"}], in the order given; `waited_for` is empty if it waited for none.
Value waits_value(const std::vector<PlayedTask>& tasks);

}  // namespace trb
