// A simulation's answer as played tasks, and their waits as JSON.
#pragma once

#include <vector>

#include "common/scenario/critical_path.hpp"
#include "common/scenario/definition.hpp"
#include "proto/value.hpp"

namespace trb {

/// The attempts in the answer's `tasks`, by begin; times count from the first one's, as the answer's `makespan_s` does.
/// Of a task's attempts those count that were done, or if none was, the last one that has failed (`failed_s`).
/// `after`: in place of a predecessor without an attempt (it was skipped) those before it. What is no task of the
/// scenario is left out.
std::vector<PlayedTask> played_tasks(const Value& answer, const Scenario& scenario);

/// [{"task", "waited_for", "robot_busy", "critical", "tried_again", "more_s"}] of the attempts that count, in the order
/// given; `waited_for` is empty if it waited for none; `tried_again`: it waited for an attempt of its own task, which
/// failed; `more_s`: as in TaskWait, to the millisecond.
Value waits_value(const std::vector<PlayedTask>& tasks);

}  // namespace trb
