// What becomes of a task whose attempt was not done.
#pragma once

#include "proto/bodies/robot.hpp"
#include "proto/bodies/run.hpp"
#include "services/scheduler/core/permit.hpp"

namespace trb::scheduler {

/// All on which it depends, beside how the attempt ended.
struct FailureRules {
  Permit permit{};
  bool may_retry = false;   ///< the robot has tries left
  bool repeatable = false;  ///< its skill does no harm if it is done twice
  OnFailure on_failure{};   ///< the task's, once it is not tried again
};

struct AfterFailure {
  TaskOutcome outcome{};
  bool goes_on = false;  ///< skipped, and the tasks behind it are done all the same
};

/// The robot tries again (retriable), the task is skipped, or what happened stands. What nobody knows to be undone
/// (interrupted) is tried again only if the skill is repeatable. `how`: any outcome; those that are no failure stand.
[[nodiscard]] AfterFailure after_failure(TaskOutcome how, const FailureRules& rules);

}  // namespace trb::scheduler
