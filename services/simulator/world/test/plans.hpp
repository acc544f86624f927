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

inline void check_unbroken(const PlayedRun& is) {
  for (const std::string& broken : is.broken) MESSAGE(broken);
  CHECK(is.broken.empty());
}

/// All of the run's tasks are done, and nothing was broken.
inline void check_finished(const Played& is, std::size_t tasks) {
  check_unbroken(is);
  CHECK(is.state == RunState::finished);
  CHECK(is.tasks_done == tasks);
}

/// And every node knows it.
inline void check_all_done(const Played& is, std::size_t tasks) {
  check_finished(is, tasks);
  CHECK(is.over_everywhere);
}

/// The same of a run beside the first one.
inline void check_run_done(const PlayedRun& is, std::size_t tasks) {
  check_unbroken(is);
  CHECK(is.state == RunState::finished);
  CHECK(is.tasks_done == tasks);
  CHECK(is.over_everywhere);
}

}  // namespace trb::world::test
