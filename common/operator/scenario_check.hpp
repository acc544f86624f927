// A scenario before it runs: its faults, who does its tasks, and what nobody else could do.
#pragma once

#include <string>
#include <vector>

#include "common/operator/session.hpp"
#include "common/scenario/candidate_index.hpp"

namespace trb::op {

/// The text of a scenario file. What is wrong with it is added to `faults`, under the name `file`.
Scenario parse_scenario(const std::string& text, const std::string& file, ConfigFaults& faults);

/// What the nodes tell of themselves; of a node that is not reached, its link's state is its robot's.
Profiles profiles_of(const RouteTable& table);

struct ScenarioCheck {
  ConfigFaults faults;
  std::vector<NoSpare> without_spare;  ///< if no fault stops the scenario
};

/// Checks the scenario against what the node knows of the fleet. Errors: those of Session::request.
void check_with_fleet(Session& session, Scenario scenario, std::string file, const Callback<ScenarioCheck>& done);

}  // namespace trb::op
