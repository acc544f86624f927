// A scenario's file before it runs.
#pragma once

#include <string>

#include "common/operator/scenario_check.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// `trb scenario check FILE`.
int run_scenario_check(const Arguments& arguments);

/// Reads the file; before a probe changes the working directory.
Scenario read_file_scenario(const std::string& path, ConfigFaults& faults);

}  // namespace trb::cli
