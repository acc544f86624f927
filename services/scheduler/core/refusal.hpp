// How a message is refused.
#pragma once

#include "common/actor/inbound.hpp"
#include "common/base/result.hpp"
#include "services/scheduler/core/run/run.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

/// The negative answer, counted; information is only counted.
void refuse(const Inbound& from, const Error& error, Step step);
/// Logs that the own router has signed something else than was requested, which is requested again.
void log_wrong_signature(const Error& error, Step step);
/// The run has another identity key of this node than it signs with, so that no member believes what it signs now: it
/// begins nothing more in that run. Logged once.
void withhold_unsigned(Run& run, Step step);
/// For what only the own node may send.
Error not_own(const Inbound& from);

}  // namespace trb::scheduler
