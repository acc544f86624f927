// A sensor of the world: what its node tells of it, and its value over time.
#pragma once

#include "common/simulation/planned_sensor.hpp"

namespace trb::world {

using simulation::Course;
using simulation::Measured;
using simulation::PlannedSensor;

}  // namespace trb::world
