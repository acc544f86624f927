// Bodies between a mode-adapter and the process that speaks a foreign middleware for it (trb-MODE-bridge). Both are
// services of one node.
#pragma once

#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

enum class BridgeAction : std::uint8_t {
  publish = 0,  ///< send `data` under `name` once; `done` when there was a receiver for it
  ask,          ///< wait for the next message under `name`: one `value`
  watch,        ///< from now on a `value` for each message under `name`, at most ten a second; also for one that
                ///< cannot be used: the value is unknown then
  unwatch,      ///< ends all that has that token: a watch, an ask, and a publication that has not left yet
};
constexpr auto enum_names(BridgeAction) {
  return std::array<std::string_view, 4>{"publish", "ask", "watch", "unwatch"};
}

/// Mode-adapter -> bridge (command). It ends with a BridgeEvent of the same token; a watch ends with the bridge, with
/// `unwatch`, or with `failed`: nothing can come of it. The mode-adapter counts what goes to the robot, so all three
/// bodies are upkeep here.
struct BridgeCommand {
  static constexpr std::string_view kSubtype = "bridge_command";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"mode-adapter"});
  std::uint64_t instance = 0;  ///< of the mode-adapter: a new instance ends the commands and watches of the old one
  std::uint64_t token = 0;
  BridgeAction action{};
  std::string name;                ///< a ROS topic
  std::string type;                ///< the topic's type; empty: the type in use
  std::string data;                ///< JSON
  std::vector<std::string> paths;  ///< of a value: only these fields, such as "pose.position.x"; empty: all
  double timeout_s = 5;
  template <class T = BridgeCommand>
  static FieldTable fields() {
    return FieldTable{field("instance", &T::instance), field("token", &T::token),        field("action", &T::action),
                      field("name", &T::name),         field("type", &T::type),          field("data", &T::data, 65536),
                      field("paths", &T::paths, 32),   field("timeout_s", &T::timeout_s)};
  }
};

enum class BridgeResult : std::uint8_t { done = 0, value, failed };
constexpr auto enum_names(BridgeResult) {
  return std::array<std::string_view, 3>{"done", "value", "failed"};
}

/// Bridge -> mode-adapter (information).
struct BridgeEvent {
  static constexpr std::string_view kSubtype = "bridge_event";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"ros-bridge"});
  std::uint64_t instance = 0;  ///< as in the command
  std::uint64_t token = 0;
  BridgeResult result{};
  std::string data;  ///< of a value: JSON; empty: unknown, because the newest message could not be used
  std::string code;  ///< of a failure, or of why a value is unknown: an Errc's name
  std::string what;
  std::string hint;
  template <class T = BridgeEvent>
  static FieldTable fields() {
    return FieldTable{field("instance", &T::instance), field("token", &T::token),   field("result", &T::result),
                      field("data", &T::data, 65536),  field("code", &T::code, 32), field("what", &T::what, 1024),
                      field("cure", &T::hint, 1024)};
  }
};

/// Bridge -> mode-adapter (information), at each change and every second.
struct BridgeState {
  static constexpr std::string_view kSubtype = "bridge_state";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"ros-bridge"});
  std::uint64_t connection = 0;  ///< a new number: whatever was running or watched before is forgotten
  bool up = false;
  std::string detail;  ///< why not
  template <class T = BridgeState>
  static FieldTable fields() {
    return FieldTable{field("connection", &T::connection), field("up", &T::up), field("detail", &T::detail)};
  }
};

}  // namespace trb
