#include "services/virtual-robots/ros/virtual_ros.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

Pose pose_of(std::string_view text) {
  const auto parts = split(text, ',');
  if (parts.size() != 3) throw OptionError("--pose: write it as X,Y,YAW");
  return {number_option(parts[0], -1e6, 1e6), number_option(parts[1], -1e6, 1e6), number_option(parts[2], -100, 100)};
}

std::vector<Option> options_of(ros::Settings& settings) {
  return {
      {"--master", "URI", "the ROS master (http://127.0.0.1:11311/)", [&](auto text) { settings.master = text; }},
      {"--ip", "ADDRESS", "the own address, as others are told it (127.0.0.1)", [&](auto text) { settings.ip = text; }},
      {"--namespace", "NAME", "of the topics (/)", [&](auto text) { settings.name_space = text; }},
      {"--pose", "X,Y,YAW", "where it starts, in m and rad (0,0,0)",
       [&](auto text) { settings.start = pose_of(text); }},
      {"--battery", "PERCENT", "its charge at the start (100)",
       [&](auto text) { settings.battery_percent = number_option(text, 0, 100); }},
      {"--arm", "", "has an arm and its tasks", [&](auto) { settings.arm = true; }},
      speed_option(settings.speed),
      control_option(settings.control),
  };
}

}  // namespace

int main(int argc, char** argv) {
  ros::Settings settings;
  return robot_main(argc, argv,
                    {"trb-virtual-ros-robot", "a mobile base on ROS 1, with or without an arm", options_of(settings),
                     [&](const Fd& end) { ros::run_virtual_ros(settings, end); }});
}
