// The runs of a world: a hall's scenarios, or the paper's tasks in turn, which may be divided into several runs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "proto/bodies/run.hpp"
#include "services/simulator/world/fleet_plan.hpp"

namespace trb::world {

/// A run that goes on beside the first one, with the same robots.
struct PlannedRun {
  Scenario scenario;
  std::vector<std::string> assigned{};  ///< who has each of its tasks at first (see bind_tasks)
  double after_s = 0;                   ///< it is submitted so long after the first run
};

/// How tasks that are no scenario's are played.
struct Division {
  std::uint32_t runs = 1;  ///< which go on at once, each with its own robots as long as there are enough
  bool at_once = false;    ///< within a run each robot does its tasks one after the other, whatever the others do;
                           ///< else one task of the run follows the other
};

/// `count` tasks t0, t1 ..., given to the robots in turn, one after the other.
Scenario in_turn(std::uint32_t count, const std::vector<PlannedRobot>& robots);

/// What a run may have at most, as check_run_start says it: the cloud is a member, too.
constexpr std::uint32_t kMostTasksOfRun = kMaxTasks;
constexpr std::uint32_t kMostRobotsOfRun = kMaxMembers - 1;
constexpr std::uint32_t kMostRuns = 100;

/// The most tasks and robots that one run of these gets.
struct RunSize {
  std::uint32_t tasks = 0, robots = 0;
};
RunSize largest_run(std::uint32_t tasks, std::uint32_t robots, const Division& division);

/// `tasks` tasks, given to the robots in turn; and the robots divided among the runs (robot i of n is of run i * runs /
/// n; with fewer robots than runs, task i is of run i % runs). In each run they are t0, t1 ... A run that would get no
/// task is left out.
std::vector<PlannedRun> divide(std::uint32_t tasks, const std::vector<PlannedRobot>& robots, const Division& division);

}  // namespace trb::world
