// A hall's own fleet and scenario, as a job for the world.
#pragma once

#include "common/fleet/object_reader.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

/// Keys, in place of `robots` and `tasks`: `fleet`, [{"id", "profile"}] with what the robots' nodes tell the fleet of
/// them (NodeProfile as JSON; all robots are taken to be ready); `scenario`, as config/scenarios has it; optional
/// `times`, {SKILL or "task:ID": seconds, or {"mean", "deviation"}}. Tasks that name no robot are bound as `trb
/// scenario run` binds them. `sensor_values`: see sensor_job.hpp; a condition on a sensor that tells nothing is a
/// fault. Optional `beside`, [{"scenario", "after"}]: scenarios that run at the same time with the same robots, each
/// submitted `after` (0) seconds after the first. `times` are of all scenarios that have the skill or the task.
void read_fleet(ObjectReader& reader, world::WorldPlan& plan);

}  // namespace trb::simulator
