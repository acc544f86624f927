#pragma once

#include <optional>
#include <string>

#include "services/virtual-robots/ros/body.hpp"
#include "services/virtual-robots/support/socket.hpp"

namespace trb::virtual_robots::ros {

struct Settings {
  std::string master = "http://127.0.0.1:11311/";
  std::string ip = "127.0.0.1";
  std::string name_space;
  Pose start;
  double battery_percent = 100;
  double speed = 1;
  bool arm = false;
  std::optional<Endpoint> control;
};

/** Waits for the ROS master, then runs the robot until `end` becomes readable or `quit` is read. */
void run_virtual_ros(const Settings& settings, const Fd& end);

}  // namespace trb::virtual_robots::ros
