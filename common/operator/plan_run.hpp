// A run before it is submitted: the scenario, checked against the fleet, and who has each task at the start.
#pragma once

#include <string>
#include <vector>

#include "common/operator/find_binder.hpp"
#include "common/operator/session.hpp"
#include "common/scenario/definition.hpp"

namespace trb::op {

struct RunPlan {
  Scenario scenario;
  RouteTable table;  ///< the fleet at the time of planning
  Binder binder;
  std::vector<std::string> robots;  ///< for each task; empty if a fault prevents the run
  ConfigFaults faults;              ///< also warnings, such as a sensor that may be plugged in later
};

/// A task that names no robot.
struct BoundTask {
  std::string task;
  std::string node;    ///< the robot that was chosen; or who chooses one when the task is due
  bool later = false;  ///< chosen when it is due
};

/// Reads the fleet's state and plans the run of a scenario without faults; `file` is its name in faults. Errors: those
/// of Session::request, and of check_whole if the scenario does not fit the table.
void plan_run(Session& session, Scenario scenario, std::string file, Callback<RunPlan> done);

std::vector<BoundTask> bound_tasks(const RunPlan& plan);

}  // namespace trb::op
