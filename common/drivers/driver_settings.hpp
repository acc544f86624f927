// What a driver is told once, at its start.
#pragma once

#include <string>

#include "common/config/node_config.hpp"
#include "common/fleet/description.hpp"

namespace trb::drivers {

struct DriverSettings {
  std::string id;  ///< the node's
  Description description;
  VendorCommands commands;
  std::uint64_t instance = 0;   ///< this process's, from the service
  std::string host{};           ///< of the robot
  std::string authorization{};  ///< how the node signs in at the robot (keys/robot.auth); secret, never logged
};

}  // namespace trb::drivers
