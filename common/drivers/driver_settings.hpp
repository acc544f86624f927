// What a driver gets once, at its start.
#pragma once

#include <string>

#include "common/config/node_config.hpp"
#include "common/fleet/description.hpp"

namespace trb::drivers {

struct DriverSettings {
  std::string id;  ///< the node's id
  Description description;
  VendorCommands commands;
  std::uint64_t instance = 0;   ///< this process's instance, from the service
  std::string host{};           ///< of the robot
  std::string authorization{};  ///< how the node authenticates to the robot (keys/robot.auth); secret, never logged
};

}  // namespace trb::drivers
