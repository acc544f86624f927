// What commands.json says for a robot that speaks ROS.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::drivers {

/// "TOPIC [TYPE] [JSON]", for example `/cmd_vel`, `/goal geometry_msgs/PoseStamped {"pose": {"position": {"x": {0}}}}`.
struct RosPublication {
  std::string topic;
  std::string type;  ///< empty: as the others on the topic have it
  std::string data;  ///< with {data} or {0}, {1} …; without any: {data}
};

/// One a line. Errors: bad_value (no topic, no type, or no JSON once the placeholders are filled).
Result<std::vector<RosPublication>> read_ros_publications(std::string_view text);

/// "TOPIC [FIELD ...]", for example `/odom pose.pose.position.x pose.pose.position.y`.
struct RosQuestion {
  std::string topic;
  std::vector<std::string> fields;
};

/// Errors: bad_value (no topic, or over 32 fields).
Result<RosQuestion> read_ros_question(std::string_view text);

}  // namespace trb::drivers
