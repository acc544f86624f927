// A job for the world: the keys of a simulation with the real cores.
#pragma once

#include "common/fleet/object_reader.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

/// Keys: `robots`, `tasks`; optional: `task_seconds` (3), `deviation` (0, of a task's time), `link`: see
/// link_job.hpp; `seed` (1), `until_event` (it ends
/// behind that event), `seconds` (at most so many are simulated), `faults` and `relays`: see fault_job.hpp;
/// `sensor_values`: see sensor_job.hpp.
world::WorldPlan read_world(ObjectReader& reader);

/// What the world adds to the answer; `cut_off`: true, if the time was up before the run was over.
Value world_value(const world::Played& played);

}  // namespace trb::simulator
