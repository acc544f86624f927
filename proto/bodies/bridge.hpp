// Bodies between a mode-adapter and the process that speaks a foreign middleware for it: trb-MODE-bridge. Both are
// services of one node.
#pragma once

#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

enum class BridgeAction : std::uint8_t {
  publish = 0,  ///< say `data` under `name` once; `done` when somebody was there to be given it
  ask,          ///< the next that is said under `name`: one `value`
  watch,        ///< from now on what is said under `name`, at most ten times a second: a `value` each
  unwatch,      ///< ends the watch of that token
};
constexpr auto enum_names(BridgeAction) {
  return std::array<std::string_view, 4>{"publish", "ask", "watch", "unwatch"};
}

/// Mode-adapter -> bridge (command). Its end is a BridgeEvent with the same token; a watch ends with the bridge or with
/// `unwatch`. What goes to the robot is counted by the mode-adapter, so all three are upkeep here.
struct BridgeCommand {
  static constexpr std::string_view kSubtype = "bridge_command";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"mode-adapter"});
  std::uint64_t instance = 0;  ///< of the mode-adapter: another one's commands and watches are over with its first
  std::uint64_t token = 0;
  BridgeAction action{};
  std::string name;                ///< a ROS topic
  std::string type;                ///< the topic's type; empty: the one that is in use
  std::string data;                ///< JSON
  std::vector<std::string> paths;  ///< of a value: the list of these alone, as "pose.position.x"; empty: all of it
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
  std::string data;  ///< of a value: JSON
  std::string code;  ///< of a failure: an Errc's name
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
  std::uint64_t connection = 0;  ///< another number: what was under way or watched before is forgotten
  bool up = false;
  std::string detail;  ///< why not
  template <class T = BridgeState>
  static FieldTable fields() {
    return FieldTable{field("connection", &T::connection), field("up", &T::up), field("detail", &T::detail)};
  }
};

}  // namespace trb
