// Tasks that name no robot, and have got none in the time in which they were to begin.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/scheduler/core/run/run.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

/// "it did not begin within 3 s: no robot was chosen"
std::string unbound_late_text(const Run& run, TaskIndex task);
/// A task's `start_within_s` in words: "3 s".
std::string within_text(const Run& run, TaskIndex task);

/// The decider's node, this one, has said that they want a robot, and has waited longer than they may, by the monotonic
/// clock. A run that was held gives them their time anew, and so does a restart. They ascend.
std::vector<TaskIndex> unbound_too_long(const Run& run, Clock clock);
/// When the next task will be one of those, after `now`; nothing: none will.
std::optional<MonotonicTime> next_unbound_too_long(const Run& run, MonotonicTime now);

}  // namespace trb::scheduler
