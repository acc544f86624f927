// The core's journal in capability.db, and what it begins from after a restart.
#pragma once

#include <vector>

#include "common/actor/outbox.hpp"
#include "services/resilience/core/resilience_core.hpp"
#include "services/resilience/io/capability_db.hpp"

namespace trb::resilience {

/// Alerts and decisions of one step, in one transaction. Errors: io_error, conflict (a decision is never replaced).
Status commit(CapabilityDb& db, const std::vector<Journal>& records);

/// The fleet, the alerts and the decisions, into an empty core; decisions that no open alert waits for are forgotten.
/// Errors: malformed (a row that no build has written), io_error.
Status restore(CapabilityDb& db, ResilienceCore& core);

}  // namespace trb::resilience
