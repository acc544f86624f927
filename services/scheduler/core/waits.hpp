// What a run and its tasks wait for, in words for a person.
#pragma once

#include <string>

#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run/run.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

/// What a run waits for: when PAUSED or ABORTING, and when this node's next task finds its robot not ready.
std::string waits_for(const Run& run, const Executor& executor, Clock clock);
/// What a task that is due waits for, as far as this node knows.
std::string due_text(const Run& run, const Executor& executor, TaskIndex task);
/// A task waits for a robot to be chosen. Choosing takes a moment; what takes longer waits for a robot to come.
bool lacks_robot(const Run& run, UtcTime steady);

}  // namespace trb::scheduler
