// A scenario before it runs: its faults, who does its tasks, and which tasks no other robot could do.
#pragma once

#include <string>
#include <vector>

#include "common/operator/session.hpp"
#include "common/scenario/candidate_index.hpp"

namespace trb::op {

/// Reads the text of a scenario file. Its faults are added to `faults`, under the name `file`.
Scenario parse_scenario(const std::string& text, const std::string& file, ConfigFaults& faults);

/// The nodes' profiles; if a node is not reached, its link's state replaces its robot's, and nobody reads its sensors.
Profiles profiles_of(const RouteTable& table);

struct ScenarioCheck {
  ConfigFaults faults;
  std::vector<NoSpare> without_spare;  ///< if no fault stops the scenario
};

/// Checks the scenario against what the node knows about the fleet. `faults` are those that its file has already: they
/// are told as well, and only what could be read is checked. Errors: those of Session::request, and of check_whole if
/// it does not fit.
void check_with_fleet(Session& session, Scenario scenario, std::string file, ConfigFaults faults,
                      const Callback<ScenarioCheck>& done);

}  // namespace trb::op
