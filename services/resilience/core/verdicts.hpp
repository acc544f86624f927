// What people, or the policy, decide on an alert, or on tasks without an alert.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/resilience/core/decisions.hpp"
#include "services/resilience/core/standing_alerts.hpp"
#include "services/resilience/core/verdict_checks.hpp"

namespace trb::resilience {

/// The objects that verdicts change. Each must outlive its users.
struct VerdictParts {
  Situation& situation;
  AlertLifecycle& alerts;
  Proposer& proposer;
  Repairs& repairs;
  Decisions& decisions;
  StandingAlerts& standing;
};

/// Results describe for people what was accepted; errors name why the verdict cannot be carried out.
class Verdicts {
 public:
  explicit Verdicts(VerdictParts parts)
      : situation_(parts.situation),
        alerts_(parts.alerts),
        repairs_(parts.repairs),
        decisions_(parts.decisions),
        standing_(parts.standing),
        checks_(parts.situation, parts.alerts, parts.proposer) {}

  /// Where a person's verdict of this node belongs, if another cloud node decides on its run. A robot's node may send
  /// it nowhere.
  [[nodiscard]] std::optional<DecidedElsewhere> elsewhere(const AlertDecide& body) const;
  /// A person's verdict, on an alert or on a run's tasks; of another cloud node only on tasks of a run of which that is
  /// a member: no other has to do with it. The person is then "ann@cloud2".
  Result<std::string> receive(const AlertDecide& body, const std::string& source, Now now, Outbox& out);
  /// A verdict on an open alert of a run.
  Result<std::string> decide(Alert& alert, const AlertDecide& body, Now now, Outbox& out);
  /// An alert that is decided as soon as it is raised, or else not raised.
  Result<std::string> decide_anew(Alert fresh, const AlertDecide& body, Now now, Outbox& out);

 private:
  /// In this node's terms: alerts have other ids at its sender.
  Result<AlertDecide> of_other_cloud(AlertDecide body, const std::string& source);
  Result<std::string> receive_own(const AlertDecide& body, Now now, Outbox& out);
  Result<std::string> decide_alert(Alert& alert, const AlertDecide& body, Now now, Outbox& out);
  Result<std::string> decide_again(Alert& alert, const AlertDecide& body, Now now, Outbox& out);
  Result<std::string> mend_again(Alert& alert, const AlertDecide& body, Now now, Outbox& out);
  Result<std::string> decide_lone(Alert& alert, const AlertDecide& body, Now now, Outbox& out);
  std::string forget_robot(Alert& alert, const AlertDecide& body, Now now, Outbox& out);
  Result<std::string> decide_tasks(const AlertDecide& body, Now now, Outbox& out);
  [[nodiscard]] Alert* alert_of_fault(const Alert& alert);
  [[nodiscard]] Result<const WatchedRun*> choose_run(const std::string& beginning) const;
  [[nodiscard]] Result<Alert*> alert_of_tasks(const WatchedRun& run, const std::vector<std::string>& tasks);

  Situation& situation_;
  AlertLifecycle& alerts_;
  Repairs& repairs_;
  Decisions& decisions_;
  StandingAlerts& standing_;
  VerdictChecks checks_;
};

}  // namespace trb::resilience
