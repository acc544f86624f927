// trb-ros-bridge NODE_DIR: the ROS half of the mode-adapter. See README.md.
#include "common/service/service_main.hpp"
#include "services/ros-bridge/io/start.hpp"

int main(int argc, char** argv) {
  return trb::service_main(argc, argv,
                           {"ros-bridge", "Publishes and subscribes to ROS topics for the node's mode-adapter.",
                            "nodes/ridgeback", trb::ros::start, nullptr, true});
}
