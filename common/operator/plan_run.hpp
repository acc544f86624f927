// A run before it is submitted: the scenario, checked against the fleet, and who holds each task at the start.
#pragma once

#include <string>
#include <vector>

#include "common/operator/find_binder.hpp"
#include "common/operator/session.hpp"
#include "common/scenario/definition.hpp"

namespace trb::op {

struct RunPlan {
  Scenario scenario;
  RouteTable table;  ///< the fleet as it was looked at
  Binder binder;
  std::vector<std::string> robots;  ///< for each task; empty if a fault stops the run
  ConfigFaults faults;              ///< also what may wait, as a sensor that is plugged in later
};

/// A task that names no robot.
struct BoundTask {
  std::string task;
  std::string node;    ///< the robot that was chosen; or who chooses one when the task is due
  bool later = false;  ///< chosen when it is due
};

/// Looks at the fleet and plans the run of a scenario that was read without a fault; `file` is its name in faults.
/// Errors: those of Session::request.
void plan_run(Session& session, Scenario scenario, std::string file, Callback<RunPlan> done);

std::vector<BoundTask> bound_tasks(const RunPlan& plan);

}  // namespace trb::op
