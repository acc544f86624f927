// The core's journal in capability.db, and the state with which it begins after a restart.
#pragma once

#include <vector>

#include "common/actor/outbox.hpp"
#include "services/resilience/core/resilience_core.hpp"
#include "services/resilience/io/capability_db.hpp"

namespace trb::resilience {

/// Alerts and decisions of one step, in one transaction. Errors: io_error, conflict (a decision is never replaced).
Status commit(CapabilityDb& db, const std::vector<Journal>& records);

/// Loads the fleet, the alerts and the decisions into an empty core; removes alerts that are too large to be read, and
/// decisions for which no open alert waits.
/// Errors: malformed (a row that no build has written), io_error.
Status restore(CapabilityDb& db, ResilienceCore& core);

}  // namespace trb::resilience
