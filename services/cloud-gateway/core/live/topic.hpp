// The topics that a client can subscribe to: fleet, robot/ID, run/ID, alerts, sensor/NODE/NAME, messages, teleop.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"

namespace trb::gateway {

enum class TopicKind : std::uint8_t { fleet = 0, robot, run, alerts, sensor, messages, teleop };
constexpr auto enum_names(TopicKind) {
  return std::array<std::string_view, 7>{"fleet", "robot", "run", "alerts", "sensor", "messages", "teleop"};
}

struct Topic {
  TopicKind kind{};
  std::string id;    ///< the robot, the run, or the sensor's node
  std::string name;  ///< the sensor
  auto operator<=>(const Topic&) const = default;
};

/// Errors: bad_value, too_large; the text names the wrong part.
Result<Topic> parse_topic(std::string_view text);
std::string text_of(const Topic& topic);

/// A topic has all rows of this stream; for `single`: those of keys_of(); `messages` has none.
RowStream stream_of(const Topic& topic);
std::vector<RowKey> keys_of(const Topic& topic);

}  // namespace trb::gateway
