// What goes wrong in a world, as a job says it.
#pragma once

#include "common/fleet/object_reader.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

constexpr std::size_t kMaxFaults = 1000;

/// Key `faults`, optional: a list of {"at", "kind", ...}; services/simulator/README.md has each kind's keys. `at`
/// counts from the run's submission; a cut, partition, clock, disk or battery without it is so from the world's start.
/// Key `relays`, optional: the nodes that relay. Every fault of the job is added, by its key.
void read_faults(ObjectReader& reader, world::WorldPlan& plan);

}  // namespace trb::simulator
