// What this node states about a run, made from the facts: drafts that the router signs.
#pragma once

#include <string>

#include "services/scheduler/core/run/run.hpp"

namespace trb::scheduler {

/// SKIPPED, with the reason.
TaskResult skipped_result(const Run& run, TaskIndex task, UtcTime now);
/// `released`, by a robot or for want of one.
TaskResult released_result(const Run& run, TaskIndex task, UtcTime now);
/// `failed` without having been begun; SKIPPED if the scenario says so.
TaskResult unbegun_result(const Run& run, TaskIndex task, const std::string& why, UtcTime now);
/// The verdicts of one reading on these tasks; all have the same source.
Choice choice_by(const Run& run, const std::vector<TaskIndex>& tasks, const std::string& node,
                 const SensorReading& reading, UtcTime now);
/// The order that a task's failure makes this node give.
AbortOrder abort_order(const Run& run, TaskIndex failed, UtcTime now);
/// The same of a task that was never begun.
AbortOrder abort_order(const Run& run, TaskIndex unbegun, const std::string& why, UtcTime now);
/// The order that tasks done twice make the judge give.
PauseOrder hold_order(const Run& run, UtcTime now);

}  // namespace trb::scheduler
