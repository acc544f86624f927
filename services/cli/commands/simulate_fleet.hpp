// `trb simulate --fleet DIR --scenario FILE`.
#pragma once

#include "services/cli/core/arguments.hpp"

namespace trb::cli {

int run_simulate_fleet(const Arguments& arguments);

}  // namespace trb::cli
