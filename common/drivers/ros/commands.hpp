// The parsed content of commands.json for a robot with ROS.
#pragma once

#include <map>

#include "common/drivers/ros/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct RosCommands {
  std::map<std::string, std::vector<RosPublication>, std::less<>> commands;  ///< by subtype
  std::map<std::string, RosQuestion, std::less<>> requests;                  ///< by subtype
};

/// Faulty entries are left out.
RosCommands read_ros_commands(const VendorCommands& vendor, const Description& description, const VendorFaults& faults);

}  // namespace trb::drivers
