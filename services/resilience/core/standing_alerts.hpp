// Faults that stand and that no run's alert covers: each becomes an alert without a run.
#pragma once

#include "services/resilience/core/repairs.hpp"
#include "services/resilience/core/uncovered_faults.hpp"

namespace trb::resilience {

class StandingAlerts {
 public:
  StandingAlerts(Situation& situation, AlertLifecycle& alerts, Repairs& repairs)
      : situation_(situation), alerts_(alerts), repairs_(repairs) {}

  /// Raises the alerts of faults that were uncovered for long enough.
  void raise_due(Now now, Outbox& out);
  /// Raises the alert of a standing fault. nullptr: too many alerts are open.
  Alert* raise(const UncoveredFaults::Key& fault, Now now, Outbox& out);
  /// The alert stays as long as the fault, and gets worse with it, or until a run's alert covers it.
  void look(Alert& alert, Now now, Outbox& out);
  /// When the next fault has been uncovered for long enough.
  [[nodiscard]] std::optional<MonotonicTime> next(Now now);

 private:
  Situation& situation_;
  AlertLifecycle& alerts_;
  Repairs& repairs_;
  UncoveredFaults uncovered_;
};

}  // namespace trb::resilience
