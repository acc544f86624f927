// From a verdict to the decision, or the order to abort, that the own scheduler gets.
#pragma once

#include <string>
#include <vector>

#include "services/resilience/core/repairs.hpp"

namespace trb::resilience {

class Decisions {
 public:
  Decisions(Situation& situation, AlertLifecycle& alerts, Repairs& repairs)
      : situation_(situation), alerts_(alerts), repairs_(repairs) {}

  /// The next step of an alert with a verdict.
  void advance(Alert& alert, Now now, Outbox& out);
  /// The verdict has waited for long, and nothing is signed yet: another verdict is allowed.
  [[nodiscard]] bool is_stuck(const Alert& alert, Now now) const;

  /// The router has signed a record.
  void receive(const SignedRecord& record, Outbox& out);
  /// The scheduler has accepted the record sent last; its view shows the effect.
  void on_accepted();
  /// The scheduler refuses the record sent last, or did not get it.
  void on_refused(const Nack& nack, Outbox& out);

 private:
  void advance_abort(Alert& alert, const WatchedRun& run, Now now, Outbox& out);
  void advance_decision(Alert& alert, const WatchedRun& run, Now now, Outbox& out);
  void sign(Alert& alert, const WatchedRun& run, std::vector<TaskRuling> rulings, Now now, Outbox& out);
  [[nodiscard]] bool add_members(Decision& decision, Alert& alert, const WatchedRun& run, Now now, Outbox& out);
  void hand_on(Alert& alert, const WatchedRun& run, Now now, Outbox& out);
  [[nodiscard]] bool take_turn(const std::string& alert, Now now);
  [[nodiscard]] std::string busy_with(const Alert& alert);

  Situation& situation_;
  AlertLifecycle& alerts_;
  Repairs& repairs_;
  std::string handed_;  ///< the alert whose decision or order was sent last
};

}  // namespace trb::resilience
