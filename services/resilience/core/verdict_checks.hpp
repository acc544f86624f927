// Refuses a verdict that cannot be carried out, when it is given.
#pragma once

#include "services/resilience/core/proposer.hpp"

namespace trb::resilience {

/// Does each of its tasks go to the robot that a person was shown? Tasks that have ended since then do not count.
/// Nothing was shown: it does.
bool is_as_shown(const Proposal& proposal, const std::vector<TaskForRobot>& shown);

class VerdictChecks {
 public:
  VerdictChecks(Situation& situation, AlertLifecycle& alerts, Proposer& proposer)
      : situation_(situation), alerts_(alerts), proposer_(proposer) {}

  /// Does this node decide on the alert's run now, and does its cause allow the verdict? Errors: unknown_run,
  /// not_permitted, missing (no verdict), conflict.
  [[nodiscard]] Status check_decider(const Alert& alert, const WatchedRun* run, const AlertDecide& body) const;
  /// Applies the verdict to the alert. Errors: missing, bad_value, conflict, unknown_target, malformed; the alert must
  /// not be used then.
  [[nodiscard]] Status shape(Alert& alert, const AlertDecide& body, const WatchedRun& run, Now now);

 private:
  [[nodiscard]] static Status narrow(Alert& alert, const AlertDecide& body, const WatchedRun& run);
  [[nodiscard]] Status take_proposal(Alert& alert, const AlertDecide& body, const WatchedRun& run, Now now);
  [[nodiscard]] Status take_override(Alert& alert, const AlertDecide& body, const WatchedRun& run) const;
  [[nodiscard]] Status check_override(const Alert& alert, const AlertDecide& body, const WatchedRun& run) const;
  [[nodiscard]] static Status check_able(const RobotRecord& robot, const Alert& alert, const WatchedRun& run);
  [[nodiscard]] Status check_confirmation(const Alert& alert, const AlertDecide& body, const WatchedRun& run) const;
  [[nodiscard]] Status check_retry(const Alert& alert, const WatchedRun& run, Now now) const;
  [[nodiscard]] static Status check_retry_of(const Alert& alert, const WatchedRun& run);
  [[nodiscard]] Status check_bounds(const Alert& alert, const WatchedRun& run);
  [[nodiscard]] Status check_decisions(const Alert& alert, const WatchedRun& run);

  Situation& situation_;
  AlertLifecycle& alerts_;
  Proposer& proposer_;
};

}  // namespace trb::resilience
