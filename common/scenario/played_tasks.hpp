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
/// The same of all runs that were played at once: `scenarios` are the first run's and those of the answer's `beside`.
/// Times count from the first attempt of any.
std::vector<PlayedTask> played_tasks(const Value& answer, const std::vector<Scenario>& scenarios);

/// [{"task", "waited_for", "robot_busy", "critical", "tried_again", "more_s"}] of the attempts that count, in the order
/// given; `waited_for` is empty if it waited for none; `tried_again`: it waited for an attempt of its own task, which
/// failed; `more_s`: as in TaskWait, to the millisecond. Of the attempts of that run; one whose robot another run kept
/// has also `waited_for_run`, whose task `waited_for` is, and `kept_s`.
Value waits_value(const std::vector<PlayedTask>& tasks, std::size_t run = 0);

/// `waits` in the answer, and in each of its `beside`. `scenarios`: as played_tasks has them.
void add_waits(Value& answer, const std::vector<Scenario>& scenarios);

}  // namespace trb
