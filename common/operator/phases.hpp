// Counters summed by the phases of Equation 12.
#pragma once

#include <cstdint>
#include <map>

#include "proto/bodies/bus.hpp"
#include "proto/phase.hpp"

namespace trb::op {

/// "sent.SUBTYPE" of a router by phase_of(SUBTYPE); "to_robot.…" and "from_robot.…" of a mode-adapter belong to the
/// task phase, except "from_robot.ready", by which the robot reports that it waits for its first instruction (boot).
std::map<CostPhase, std::uint64_t> count_phases(const Counters& counters);

}  // namespace trb::op
