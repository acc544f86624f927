// What another command needs that makes a node's folder, too.
#pragma once

#include <string>

#include "common/base/result.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// This computer's interface or address on the fleet's network: --network, the only one that it has, or what a person
/// answers. `robot_side`: an address that leads to the robot; empty: none. Errors: missing, bad_value.
Result<std::string> fleet_side_of(const Arguments& arguments, const std::string& robot_side);

}  // namespace trb::cli
