// What a run and its tasks wait for, in words for a person.
#pragma once

#include <string>

#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

/// What a run waits for: when PAUSED or ABORTING, and when this node's next task finds its robot not ready.
/// `runs`: all that this node knows of, among them what a robot does meanwhile.
std::string waits_for(const Run& run, const RunStore& runs, const Executor& executor, Clock clock);
/// What a task that is due waits for, as far as this node knows; and one that its robot will try again.
std::string due_text(const Run& run, const RunStore& runs, const Executor& executor, TaskIndex task);
/// A task waits for a robot to be chosen. Choosing takes a moment; what takes longer waits for a robot to come.
bool lacks_robot(const Run& run, Clock clock);
/// Of a run that is being recovered. What shows that this node has had it contradicts who says that it is new.
std::string recovery_text(const Run& run);

}  // namespace trb::scheduler
