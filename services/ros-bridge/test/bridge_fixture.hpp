// The bridge's core between a mode-adapter and a worker: both played by the test.
#pragma once

#include <doctest/doctest.h>

#include "services/ros-bridge/core/bridge_core.hpp"
#include "services/ros-bridge/core/message_codec.hpp"

namespace trb::ros::test {

inline constexpr std::uint64_t kAdapter = 7;

inline Result<std::string> read_definition(const std::string& type) {
  if (type == "geometry_msgs/Twist") return std::string("Vector3 linear\nVector3 angular\n");
  if (type == "geometry_msgs/Vector3") return std::string("float64 x\nfloat64 y\nfloat64 z\n");
  return fail(Errc::missing, type + ": no definition", "install its package");
}

struct Fixture {
  BridgeCore core;
  Now now{};
  Outbox out;
  WorkerReader to_worker;

  explicit Fixture(TypeStore::Read read = read_definition)
      : core({"ridgeback", "http://10.0.0.9:11311", 5}, std::move(read)) {
    core.on_welcome({"ridgeback", Role::robot, 1}, now, out);
    core.on_worker_started(now, out);
  }
  void worker(Word word, std::vector<Bytes> parts) {
    core.on_worker_bytes(to_bytes({word, std::move(parts)}), now, out);
  }
  void up() {
    worker(Word::alive, {"up", ""});
    told();
  }
  void command(std::uint64_t token, BridgeAction action, const std::string& name, const std::string& data = "",
               std::vector<std::string> paths = {}, const std::string& source = "ridgeback",
               std::uint64_t adapter = kAdapter) {
    BridgeCommand body{adapter, token, action, name, "", data, std::move(paths), 5};
    core.on({MessageType::command, source, "ridgeback", token, 0, kFlagNoAnswer, 1000, std::move(body)}, now, out);
  }
  /// A publication that waits at the worker; returns its message there.
  WorkerMessage publish() {
    up();
    command(1, BridgeAction::publish, "/cmd_vel", "{}");
    worker(Word::type, {"/cmd_vel", "geometry_msgs/Twist"});
    return said().back();
  }
  void wait(Duration time) {
    const MonotonicTime end = now.mono + time;
    while (core.next_deadline() && *core.next_deadline() <= end) {
      now.mono = std::max(now.mono, *core.next_deadline());
      core.tick(now, out);
    }
    now.mono = end;
  }
  std::vector<WorkerMessage> said() {
    std::vector<WorkerMessage> messages;
    REQUIRE(to_worker.add(core.take_worker_output().bytes, messages));
    return messages;
  }
  /// "TOKEN done", "TOKEN DATA" or "TOKEN CODE: WHAT", a line each.
  std::string told() {
    std::string text;
    for (const BridgeEvent& event : sent<BridgeEvent>(out)) {
      text += std::to_string(event.token) + " ";
      text += event.result == BridgeResult::done    ? "done"
              : event.result == BridgeResult::value ? event.data
                                                    : event.code + ": " + event.what;
      text += "\n";
    }
    states = sent<BridgeState>(out);
    out.sends.clear();
    return text;
  }
  std::vector<BridgeState> states;
};

inline const std::string kPoint = "float64 x\nfloat64 y\n";

/// A message of demo/Point on /odom.
inline std::vector<Bytes> odometry(double x, double y) {
  const auto type = *type_from_full_definition("demo/Point", kPoint);
  return {"/odom", "demo/Point", type->md5, kPoint, *to_wire(*type, Value{Value::List{Value{x}, Value{y}}})};
}

}  // namespace trb::ros::test
