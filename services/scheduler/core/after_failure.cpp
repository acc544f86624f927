#include "services/scheduler/core/after_failure.hpp"

namespace trb::scheduler {
namespace {

TaskOutcome outcome_after(TaskOutcome how, const FailureRules& rules) {
  // Who is ordered to stop has not failed by itself.
  if (rules.permit == Permit::cancel) return how;
  if (rules.permit == Permit::stop) return how == TaskOutcome::failed ? TaskOutcome::retriable : how;
  if (how != TaskOutcome::failed && how != TaskOutcome::interrupted) return how;
  const bool repeatable = how == TaskOutcome::failed || rules.repeatable;
  if (rules.may_retry && repeatable && rules.permit != Permit::too_late) return TaskOutcome::retriable;
  const bool skips = rules.on_failure == OnFailure::skip || rules.on_failure == OnFailure::continue_;
  return skips ? TaskOutcome::skipped : how;
}

}  // namespace

AfterFailure after_failure(TaskOutcome how, const FailureRules& rules) {
  const TaskOutcome outcome = outcome_after(how, rules);
  return {outcome, outcome == TaskOutcome::skipped && rules.on_failure == OnFailure::continue_};
}

}  // namespace trb::scheduler
