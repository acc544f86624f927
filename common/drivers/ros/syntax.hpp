// The notation of commands.json for a robot with ROS.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::drivers {

/// "TOPIC [TYPE] [JSON]", for example `/cmd_vel`, `/goal geometry_msgs/PoseStamped {"pose": {"position": {"x": {0}}}}`.
struct RosPublication {
  std::string topic;
  std::string type;  ///< empty: the type in use on the topic
  std::string data;  ///< with {data} or {0}, {1} …; without any: {data}
};

/// One a line. Errors: bad_value (not a topic as ROS wants it, not a type, or not JSON once the placeholders are
/// filled).
Result<std::vector<RosPublication>> read_ros_publications(std::string_view text);

/// "TOPIC [FIELD ...]", for example `/odom pose.pose.position.x pose.pose.position.y`.
struct RosQuestion {
  std::string topic;
  std::vector<std::string> fields;
};

/// Errors: bad_value (not a topic as ROS wants it, or over 32 fields).
Result<RosQuestion> read_ros_question(std::string_view text);

}  // namespace trb::drivers
