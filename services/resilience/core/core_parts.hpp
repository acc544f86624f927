// The parts of the core, each given those that it needs.
#pragma once

#include <utility>

#include "services/resilience/core/alert_updater.hpp"
#include "services/resilience/core/core_settings.hpp"
#include "services/resilience/core/detection.hpp"

namespace trb::resilience {

struct CoreParts {
  explicit CoreParts(CoreSettings settings) : situation(std::move(settings)) {}
  CoreParts(const CoreParts&) = delete;  ///< they refer to each other
  CoreParts& operator=(const CoreParts&) = delete;

  Situation situation;
  AlertLifecycle alerts{situation};
  Proposer proposer{situation, alerts};
  Repairs repairs{situation, alerts};
  Decisions decisions{situation, alerts, repairs};
  StandingAlerts standing{situation, alerts, repairs};
  Verdicts verdicts{VerdictParts{situation, alerts, proposer, repairs, decisions, standing}};
  Policy policy{situation, alerts, proposer, verdicts};
  AlertUpdater alert_updater{situation, alerts, proposer, policy};
  Detection detection{situation, alerts, proposer, verdicts};
};

}  // namespace trb::resilience
