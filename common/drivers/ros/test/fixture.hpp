// A robot with ROS: the test reads what is sent to the bridge, and answers in its place.
#pragma once

#include <vector>

#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline Settings ridgeback() {
  Settings settings = robot_settings("ridgeback", "ros", Mode::ros, "ros");
  settings.description.capabilities = {"mobile"};
  settings.description.skills = {
      make_skill("go_to", "[{place.x}, {place.y}]", {make_parameter("place", ParameterType::place)})};
  settings.description.skills[0].end.kind = EndKind::position;
  settings.description.skills[0].end.target = "place";
  settings.description.skills[0].end.tolerance = 0.05;
  settings.places = {{"dock", {1, 2, 0, 0}}};
  settings.commands.commands = {{"move", "/cmd_vel"},
                                {"go_to", R"(/goal geometry_msgs/PoseStamped {"pose":{"position":{"x":{0},"y":{1}}}})"},
                                {"stop", "/cmd_vel {}\n/arm/stop std_msgs/Empty {}"}};
  settings.commands.requests = {{"position", "/odom pose.pose.position.x pose.pose.position.y"}, {"scan", "/scan"}};
  return settings;
}

struct RosFixture : Fixture {
  explicit RosFixture(Settings settings = ridgeback()) : Fixture(std::move(settings)) { welcome(); }

  void bridge(bool is_up, std::uint64_t connection = 1, const std::string& detail = "") {
    deliver(MessageType::information, BridgeState{connection, is_up, detail}, "ridgeback");
  }
  void tell(std::uint64_t token, BridgeResult result, const std::string& data = "", const std::string& code = "") {
    deliver(MessageType::information, BridgeEvent{kInstance, token, result, data, code, code.empty() ? "" : "why", ""},
            "ridgeback");
  }
  std::vector<BridgeCommand> asked() {
    std::vector<BridgeCommand> found;
    for (const Send& send : told<BridgeCommand>()) found.push_back(get<BridgeCommand>(send.body));
    return found;
  }
};

/// ROS is there, and what is asked of it at first has been read.
struct OnlineRos : RosFixture {
  explicit OnlineRos(Settings settings = ridgeback()) : RosFixture(std::move(settings)) {
    bridge(true);
    asked();
  }
};

}  // namespace trb::adapter
