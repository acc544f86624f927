// The sensors of a world's job: what they tell over time.
#pragma once

#include "common/fleet/object_reader.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

constexpr std::size_t kMaxSensors = 1000;
constexpr std::size_t kMaxSteps = 1000;

/// Key `sensor_values`, optional: [{"node", "name", "kind", "unit", "identity", "every_s", and one of "value",
/// "steps": [{"at", "value"}], "ramp": {"from", "to", "begin", "end"}}]. A value is a number, a text, or null: it
/// cannot be read. Times in seconds from the run's submission. What is left out is as that node's profile has it, if it
/// has a sensor of that name. The profiles of the fleet get the sensors.
void read_sensor_values(ObjectReader& reader, world::WorldPlan& plan);

/// A fault for each condition of the scenario on a sensor that tells no value here, or in another unit.
void check_conditions(const world::WorldPlan& plan, const FileFaults& faults);

}  // namespace trb::simulator
