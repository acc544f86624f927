// What each of several runs would take by itself.
#pragma once

#include <functional>

#include "proto/value.hpp"
#include "services/simulator/world/world.hpp"

namespace trb::simulator {

/// Plays each run of the plan alone, submitted at once, and adds `alone_s` to the answer and to each of its `beside`:
/// its makespan in seconds, or null: it is not FINISHED then. `on_second`: as World's.
void add_alone(Value& answer, const world::WorldPlan& plan, const std::function<void(const world::World&)>& on_second);

}  // namespace trb::simulator
