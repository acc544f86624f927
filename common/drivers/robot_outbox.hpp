// What a driver wants done at its robot, as values: io carries it out after the step's records are on disk and its
// messages are sent.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/bytes.hpp"

namespace trb {

/// A byte stream to the robot. `field`: the robot dialled TCP_PORT; `command` and `monitor`: the node dials the robot.
enum class Channel : std::uint8_t { field = 0, command, monitor, data };
constexpr auto enum_names(Channel) {
  return std::array<std::string_view, 4>{"field", "command", "monitor", "data"};
}

struct RobotWrite {
  Channel channel{};
  Bytes bytes;
};

/// Drop the connection; io dials a dialled channel again, with back-off.
struct RobotClose {
  Channel channel{};
  std::string reason;
};

/// Collects one step's writes, and then its closes.
class RobotOutbox {
 public:
  std::vector<RobotWrite> writes;
  std::vector<RobotClose> closes;

  void write(Channel channel, Bytes bytes) { writes.push_back({channel, std::move(bytes)}); }
  void close(Channel channel, std::string reason) { closes.push_back({channel, std::move(reason)}); }

  [[nodiscard]] bool empty() const { return writes.empty() && closes.empty(); }
};

}  // namespace trb
