// The words that a client subscribes by: fleet, robot/ID, run/ID, alerts, sensor/NODE/NAME, messages, teleop.
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
  std::string id;    ///< of a robot or a run; a sensor's node
  std::string name;  ///< of a sensor
  auto operator<=>(const Topic&) const = default;
};

/// Errors: bad_value, too_large; the text names the part.
Result<Topic> parse_topic(std::string_view text);
std::string text_of(const Topic& topic);

/// Its rows are all those of that stream; `single`: those of keys_of(), and of messages none.
RowStream stream_of(const Topic& topic);
std::vector<RowKey> keys_of(const Topic& topic);

}  // namespace trb::gateway
