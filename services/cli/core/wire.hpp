// The robot's wire: what `trb check` has to say of it.
#pragma once

#include <string>

namespace trb::cli {

/// What to tell if the robot is reached on the fleet's own interface; empty: nothing. Addresses of this machine alone
/// are no wire.
std::string note_of_wire(const std::string& fleet_address, const std::string& robot_address,
                         const std::string& robot_host);

}  // namespace trb::cli
