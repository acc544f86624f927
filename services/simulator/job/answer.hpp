// What a simulation has found, as JSON.
#pragma once

#include "proto/value.hpp"
#include "services/simulator/counting/tally.hpp"
#include "services/simulator/world/meter.hpp"

namespace trb::simulator {

/// {"seconds", "messages", "bytes", "between_computers": {"messages", "bytes"}, "phases": {PHASE: {"messages", "bytes",
/// "between_computers": {...}}}, "over_time": {"interval_s", "messages": [...], "bytes": [...]}}; over time up to
/// `seconds`, the run's end.
Value answer_value(const counting::Tally& tally, double seconds);

/// One line of a trace: {"at_s", "phase", "from", "to", "bytes"}.
Value trace_value(const counting::CountedMessage& message);
/// Of the world: {"at_s", "phase", "from", "to", "subtype", "bytes"}.
Value trace_value(const world::Sending& sending, CostPhase phase);

}  // namespace trb::simulator
