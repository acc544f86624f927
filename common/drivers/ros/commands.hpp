// What commands.json says for a robot that runs ROS, read.
#pragma once

#include <map>

#include "common/drivers/ros/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct RosCommands {
  std::map<std::string, std::vector<RosPublication>, std::less<>> commands;  ///< by subtype
  std::map<std::string, RosQuestion, std::less<>> requests;                  ///< by subtype
};

/// What is a fault is left out.
RosCommands read_ros_commands(const VendorCommands& vendor, const Description& description, const VendorFaults& faults);

}  // namespace trb::drivers
