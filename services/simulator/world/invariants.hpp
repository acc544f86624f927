// What must hold at the end of every run, whatever went wrong.
#pragma once

#include <string>
#include <vector>

#include "services/simulator/world/world.hpp"

namespace trb::world {

/// Those that do not hold of a run, as text: every task that a finished run calls FINISHED was done once and none other
/// was done; what was accepted is known; no attempt was begun twice; the run is over at every member that is up, unless
/// its time was up while it was under way. Of the first run also what is of no single one: no robot was told two things
/// at once, or began a task of a run that nobody submitted; no message was unreadable.
std::vector<std::string> broken_invariants(const World& world, const WorldRun& run);

}  // namespace trb::world
