// trb-ros-bridge NODE_DIR: the ROS half of the mode-adapter. See README.md.
#include <cstdio>
#include <cstring>
#include <exception>

#include "services/ros-bridge/io/start.hpp"

int main(int argc, char** argv) {
  if (argc != 2 || std::strcmp(argv[1], "--help") == 0) {
    std::puts(
        "trb-ros-bridge NODE_DIR\n\nSays and hears ROS topics for the node's mode-adapter.\n"
        "Usually started by `trb up NODE_DIR`. Example: trb-ros-bridge nodes/ridgeback");
    return argc == 2 ? 0 : 2;
  }
  try {
    return trb::ros::start(argv[1]);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb-ros-bridge: %s\n", problem.what());
    return 1;
  }
}
