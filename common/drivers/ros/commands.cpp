#include "common/drivers/ros/commands.hpp"

namespace trb::drivers {

RosCommands read_ros_commands(const VendorCommands& vendor, const Description&, const VendorFaults& faults) {
  return {read_part("commands", vendor.commands, faults, read_ros_publications),
          read_part("requests", vendor.requests, faults, read_ros_question)};
}

}  // namespace trb::drivers
