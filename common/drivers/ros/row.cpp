// A robot that runs ROS 1, by the ros-bridge.
#include "common/drivers/registry.hpp"
#include "common/drivers/ros/driver.hpp"

namespace trb::drivers {

void check_ros(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow ros_row() {
  DriverRow row;
  row.transport.name = "ros";
  row.transport.mode = Mode::ros;
  row.transport.check = check_ros;
  row.wire = Wire::none;
  row.make = make_with<RosDriver, read_ros_commands>;
  return row;
}

}  // namespace trb::drivers
