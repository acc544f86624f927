// Updates an open alert of a run: its proposals, its time, what it waits for, and the policy.
#pragma once

#include <string>

#include "services/resilience/core/policy.hpp"

namespace trb::resilience {

class AlertUpdater {
 public:
  AlertUpdater(Situation& situation, AlertLifecycle& alerts, Proposer& proposer, Policy& policy)
      : situation_(situation), alerts_(alerts), proposer_(proposer), policy_(policy) {}

  void look(Alert& alert, Now now, Outbox& out);

 private:
  void wait_for_members(Alert& alert, const WatchedRun& run);
  static void look_at_notice(Alert& alert, const WatchedRun& run, Now now);
  [[nodiscard]] bool is_expired(const Alert& alert, Now now) const;
  static void expire(Alert& alert, Outbox& out);
  [[nodiscard]] std::string why_word(const Alert& alert, const WatchedRun& run) const;
  [[nodiscard]] std::string waits_for(const Alert& alert, const WatchedRun& run) const;

  Situation& situation_;
  AlertLifecycle& alerts_;
  Proposer& proposer_;
  Policy& policy_;
};

}  // namespace trb::resilience
