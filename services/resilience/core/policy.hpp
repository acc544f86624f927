// Decides on an open alert without a person, where the policy allows it.
#pragma once

#include <string>

#include "services/resilience/core/verdicts.hpp"

namespace trb::resilience {

class Policy {
 public:
  Policy(Situation& situation, AlertLifecycle& alerts, Proposer& proposer, Verdicts& verdicts)
      : situation_(situation), alerts_(alerts), proposer_(proposer), verdicts_(verdicts) {}

  /// Decides if nothing prevents it; else the alert shows what does.
  void try_decide(Alert& alert, Now now, Outbox& out);

 private:
  [[nodiscard]] std::string why_not(const Alert& alert, Now now);
  [[nodiscard]] std::string why_ask(const Alert& alert, const AlertWork& work, Now now) const;
  [[nodiscard]] std::string why_wait(const Alert& alert, const AlertWork& work, Now now);
  [[nodiscard]] std::string why_moved_enough(const Alert& alert) const;

  Situation& situation_;
  AlertLifecycle& alerts_;
  Proposer& proposer_;
  Verdicts& verdicts_;
};

}  // namespace trb::resilience
