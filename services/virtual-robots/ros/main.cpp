#include <unistd.h>

#include <cstdio>
#include <exception>

#include "services/virtual-robots/ros/virtual_ros.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/options.hpp"
#include "services/virtual-robots/support/process.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

/** What the command line asks for. */
struct Request {
  ros::Settings settings;
  bool die_with_parent = false;
};

ros::Pose pose_of(std::string_view text) {
  const auto parts = split(text, ',');
  if (parts.size() != 3) throw OptionError("--pose: write it as X,Y,YAW");
  return {number_option(parts[0], -1e6, 1e6), number_option(parts[1], -1e6, 1e6), number_option(parts[2], -100, 100)};
}

std::vector<Option> options_of(Request& request) {
  ros::Settings& settings = request.settings;
  return {
      {"--master", "URI", "the ROS master (http://127.0.0.1:11311/)", [&](auto text) { settings.master = text; }},
      {"--ip", "ADDRESS", "the own address, as others are told it (127.0.0.1)", [&](auto text) { settings.ip = text; }},
      {"--namespace", "NAME", "of the topics (/)", [&](auto text) { settings.name_space = text; }},
      {"--pose", "X,Y,YAW", "where it starts, in m and rad (0,0,0)",
       [&](auto text) { settings.start = pose_of(text); }},
      {"--battery", "PERCENT", "its charge at the start (100)",
       [&](auto text) { settings.battery_percent = number_option(text, 0, 100); }},
      {"--arm", "", "has an arm and its tasks", [&](auto) { settings.arm = true; }},
      {"--speed", "N", "robot time runs N times faster (1)",
       [&](auto text) { settings.speed = number_option(text, 0.001, 100000); }},
      control_option(settings.control),
      {"--die-with-parent", "", "end when the starting process ends", [&](auto) { request.die_with_parent = true; }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  const int parent = ::getppid();
  Request request;
  const std::vector<Option> options = options_of(request);
  try {
    if (!parse_options({argv + 1, argv + argc}, options)) {
      std::fputs(
          describe_options("trb-virtual-ros-robot", "a mobile base on ROS 1, with or without an arm", options).c_str(),
          stdout);
      return 0;
    }
    const Fd end = catch_end_signals();
    if (request.die_with_parent && !die_with_parent(parent)) return 1;
    ros::run_virtual_ros(request.settings, end);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trb-virtual-ros-robot: %s\n", error.what());
    return 2;
  }
}
