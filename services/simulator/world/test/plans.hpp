// What the world's tests have alike.
#pragma once

#include <doctest/doctest.h>

#include "services/simulator/world/world.hpp"

namespace trb::world::test {

inline WorldPlan plan_of(std::uint32_t robots, std::uint32_t tasks, std::vector<Fault> faults = {},
                         std::uint64_t seed = 1) {
  WorldPlan plan;
  plan.robots = robots;
  plan.tasks = tasks;
  plan.faults = std::move(faults);
  plan.seed = seed;
  return plan;
}

inline void check_unbroken(const Played& is) {
  for (const std::string& broken : is.broken) MESSAGE(broken);
  CHECK(is.broken.empty());
}

}  // namespace trb::world::test
