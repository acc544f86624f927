// A robot that runs ROS 1, by the ros-bridge.
#include "common/drivers/registry.hpp"
#include "common/drivers/ros/driver.hpp"

namespace trb::drivers {

void check_ros(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow ros_row() {
  return {.transport = {.name = "ros", .mode = Mode::ros, .check = check_ros},
          .wire = Wire::none,
          .make = make_with<RosDriver, read_ros_commands>};
}

}  // namespace trb::drivers
