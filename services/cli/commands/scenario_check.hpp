// A scenario's file before it runs: its faults, who does its tasks, and what nobody else could do.
#pragma once

#include <string>
#include <vector>

#include "common/scenario/candidate_index.hpp"
#include "services/cli/core/arguments.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {

/// `trb scenario check FILE`.
int run_scenario_check(const Arguments& arguments);

Scenario read_file_scenario(const std::string& path, ConfigFaults& faults);

/// What the nodes tell of themselves; of a node that is not reached, its link's state is its robot's.
Profiles profiles_of(const RouteTable& table);

/// Who chooses the robots of a run's tasks that name none, when they are due.
struct Binder {
  std::string node;     ///< empty: nobody, they are bound at once
  std::string why_not;  ///< in words
};

/// The node that will be the decider of the run, if its resilience answers now.
Binder find_binder(Probe& probe, const Scenario& scenario, const RouteTable& table);

/// Checks the scenario against the fleet and says who holds each task at the start.
std::vector<std::string> robots_for(const Scenario& scenario, const Profiles& profiles, const Binder& binder,
                                    const std::string& path, ConfigFaults& faults);

/// [{"task", "robot"}] of the tasks without a robot; {"task", "by"} if it is chosen later.
Value::List bound_json(const Scenario& scenario, const std::vector<std::string>& robots, const Binder& binder);

/// What may wait (a sensor that is plugged in later) to standard error, and what becomes of tasks without a robot.
void print_bound(const Scenario& scenario, const std::vector<std::string>& robots, const Binder& binder,
                 const ConfigFaults& faults);

}  // namespace trb::cli
