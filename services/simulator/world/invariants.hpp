// What must hold at the end of every run, whatever went wrong.
#pragma once

#include <string>
#include <vector>

#include "services/simulator/world/world.hpp"

namespace trb::world {

/// Those that do not hold, as text: every task that a finished run calls FINISHED was done once and none other was
/// done; what was accepted is known; no attempt was begun twice; no robot was told two things at once; the run is over
/// at every member that is up, unless its time was up while it was under way; no message was unreadable.
std::vector<std::string> broken_invariants(const World& world, const Played& played);

}  // namespace trb::world
