// A core, the clock of its test, and the messages and bytes since the last look.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "services/mode-adapter/core/adapter_core.hpp"

namespace trb::adapter {

constexpr std::uint64_t kInstance = 77;

inline Skill make_skill(const std::string& name, const std::string& data, std::vector<Parameter> parameters = {}) {
  Skill skill;
  skill.name = name;
  skill.capability = "mobile";
  skill.subtype = name;
  skill.data = data;
  skill.parameters = std::move(parameters);
  skill.timeout_s = 10;
  return skill;
}

inline Parameter make_parameter(const std::string& name, ParameterType type, const std::string& unit = {}) {
  Parameter parameter;
  parameter.name = name;
  parameter.type = type;
  parameter.unit = unit;
  return parameter;
}

/// A robot of that transport, without its commands.
inline Settings robot_settings(const std::string& id, const std::string& framework, Mode mode,
                               const std::string& transport) {
  Settings settings;
  settings.id = id;
  settings.framework = framework;
  settings.mode = mode;
  settings.commands.transport = transport;
  settings.instance = kInstance;
  return settings;
}

/// A mobile robot with the field channel.
inline Settings pioneer() {
  Settings settings = robot_settings("pioneer", "pioneer", Mode::interpreter, "lines");
  settings.description.capabilities = {"mobile"};
  settings.description.skills = {
      make_skill("go_to", "{place.x} {place.y}", {make_parameter("place", ParameterType::place)}),
      make_skill("home", "")};
  settings.places = {{"dock", {1, 2, 0, 0}}};
  return settings;
}

/// The joints of an arm that stands upright, as data.
constexpr const char* kUpright = "[0, -1.5708, 0, -1.5708, 0, 0]";

/// An arm that accepts URScript.
inline Settings ur3() {
  Settings settings = robot_settings("ur3", "ur", Mode::direct, "tcp-text");
  settings.description.capabilities = {"grab", "reach"};
  Parameter joints = make_parameter("joints", ParameterType::numbers, "rad");
  joints.count = 6;
  settings.description.skills = {make_skill("reach", "{joints}", {joints})};
  settings.description.skills[0].subtype = "move";
  settings.commands.port = 30002;
  settings.commands.language = "urscript";
  settings.commands.wrap = "urscript-program";
  settings.commands.monitor = Monitor{"ur-primary", 30001};
  settings.commands.commands = {{"move", "movej({data})"},
                                {"say", "textmsg({data})"},
                                {"power", "power on"},
                                {"stop", "stop program"},
                                {"release", ""}};
  settings.commands.requests = {{"position", "joints"}, {"mode", "robot_mode"}};
  return settings;
}

class Fixture {
 public:
  explicit Fixture(Settings settings)
      : core(
            std::move(settings),
            [this](bool fenced) {
              fence_writes.push_back(fenced);
              return fence_status;
            },
            [this](const std::vector<Kept>& lines) {
              if (kept_status) kept = lines;
              ++kept_writes;
              return kept_status;
            }) {}

  // what comes in
  std::uint64_t send(MessageType type, const std::string& subtype, const std::string& data,
                     const std::string& source = "operator") {
    return deliver(type, Opaque{subtype, data}, source);
  }
  std::uint64_t command(const std::string& subtype, const std::string& data) {
    return send(MessageType::command, subtype, data);
  }
  std::uint64_t deliver(MessageType type, Body body, const std::string& source = "operator",
                        std::uint64_t reply_to = 0) {
    core.on({type, source, "robot", ++last_id, reply_to, flags, remaining_ms, std::move(body)}, now, out);
    return last_id;
  }
  void up(Channel channel) { core.on_channel_up(channel, now, out); }
  void down(Channel channel, const std::string& reason = "gone") { core.on_channel_down(channel, reason, now, out); }
  void hear(Channel channel, BytesView bytes) { core.on_bytes(channel, bytes, now, out); }
  void say(BytesView bytes) { hear(Channel::field, bytes); }
  bool may_be_replaced() { return core.may_be_replaced(router_heard.value_or(now.mono), now, out); }
  void welcome() { core.on_welcome({"pioneer", Role::robot, 1}, now, out); }

  /// Lets time pass, from deadline to deadline.
  void wait(double time_s) {
    const MonotonicTime end = now.mono + seconds(time_s);
    for (int turns = 0; turns < 100'000; ++turns) {
      const auto next = core.next_deadline();
      if (!next || end < *next) break;
      now.mono = std::max(now.mono, *next);
      core.tick(now, out);
    }
    now.mono = end;
  }

  // what has come out; each call removes it
  std::string written(Channel channel = Channel::field) {
    std::string bytes;
    collect();
    for (const RobotWrite& write : robot.writes) {
      if (write.channel == channel) bytes += write.bytes;
    }
    std::erase_if(robot.writes, [&](const RobotWrite& write) { return write.channel == channel; });
    return bytes;
  }
  template <class T>
  std::vector<Send> told() {
    std::vector<Send> found;
    for (const Send& send : out.sends) {
      if (holds_alternative<T>(send.body)) found.push_back(send);
    }
    std::erase_if(out.sends, [](const Send& send) { return holds_alternative<T>(send.body); });
    return found;
  }
  /// The only body of that type that was sent.
  template <class T>
  T one() {
    const auto found = told<T>();
    REQUIRE(found.size() == 1);
    return get<T>(found.front().body);
  }
  /// The reason of the only outcome, which is a failure.
  std::string failure() {
    const auto outcome = one<Outcome>();
    CHECK(outcome.outcome == TaskOutcome::failed);
    return outcome.reason;
  }
  /// The faults that were reported as over: "CAPABILITY: TEXT".
  std::vector<std::string> over() {
    std::vector<std::string> texts;
    for (const Send& send : out.sends) {
      const auto* fault = get_if<RobotFault>(&send.body);
      if (fault != nullptr && fault->ended) texts.push_back(fault->capability + ": " + fault->text);
    }
    std::erase_if(out.sends, [](const Send& send) {
      const auto* fault = get_if<RobotFault>(&send.body);
      return fault != nullptr && fault->ended;
    });
    return texts;
  }
  /// "ack STATE", "nack CODE" or the data: the answer to the message; empty: none yet.
  std::string answer(std::uint64_t id) {
    for (const Send& send : out.sends) {
      if (send.reply_to != id) continue;
      if (const auto* ack = get_if<Ack>(&send.body)) return "ack " + ack->state;
      if (const auto* nack = get_if<Nack>(&send.body)) return "nack " + nack->code;
      if (const auto* opaque = get_if<Opaque>(&send.body)) return opaque->data;
      if (const auto* state = get_if<ExecutionState>(&send.body)) return state->state;
      if (const auto* end = get_if<Outcome>(&send.body)) return std::string(name_of(end->outcome));
    }
    return "";
  }
  Nack nack_of(std::uint64_t id) {
    for (const Send& send : out.sends) {
      if (send.reply_to == id && holds_alternative<Nack>(send.body)) return get<Nack>(send.body);
    }
    return {};
  }
  [[nodiscard]] long counted(const std::string& name) const {
    return std::count(out.counts.begin(), out.counts.end(), name);
  }
  std::string closed() {
    std::string reasons;
    collect();
    for (const RobotClose& close : robot.closes) reasons += close.reason + ";";
    robot.closes.clear();
    return reasons;
  }
  /// What the robot has not been shown yet is in `robot` from now on.
  void collect() {
    RobotOutbox more = core.take_robot_output();
    std::move(more.writes.begin(), more.writes.end(), std::back_inserter(robot.writes));
    std::move(more.closes.begin(), more.closes.end(), std::back_inserter(robot.closes));
  }

  // an interpreter robot that acknowledges every field of a message
  std::string take_fields(int count = 5) {
    std::string fields;
    for (int i = 0; i < count; ++i) {
      fields += written();
      say("ok\n");
    }
    return fields;
  }

  std::vector<bool> fence_writes;
  Status fence_status = Done{};
  std::vector<Kept> kept;  ///< what is on disk
  int kept_writes = 0;
  Status kept_status = Done{};
  ModeAdapterCore core;
  Outbox out;
  RobotOutbox robot;
  std::optional<MonotonicTime> router_heard;  ///< empty: it is heard all the time
  Now now{{1'000'000'000}, {0}};
  std::uint64_t last_id = 0;
  std::uint32_t remaining_ms = kDefaultRemainingMs;
  std::uint16_t flags = 0;
};

inline AttemptKey attempt(std::uint32_t number = 1) {
  return {"run-1", "task-1", 1, number};
}

inline Execute order(const std::string& skill, const std::string& data, std::uint32_t number = 1) {
  return {attempt(number), 1, kInstance, skill, data, 0};
}

// Packets of a UR controller, in the measured layout.
inline std::string big_endian(std::uint64_t value, int size) {
  std::string out;
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) out += static_cast<char>((value >> shift) & 0xffU);
  return out;
}
inline std::string with_length(const std::string& body) {
  return big_endian(body.size() + 4, 4) + body;
}
inline std::string ur_message(int kind, const std::string& rest) {
  return with_length(big_endian(20, 1) + std::string(8, '\1') + '\xfd' + static_cast<char>(kind) + rest);
}
inline std::string ur_key(const std::string& title, const std::string& program) {
  return ur_message(7, std::string(8, '\0') + static_cast<char>(title.size()) + title + program);
}
inline std::string ur_started(const std::string& program) {
  return ur_key("PROGRAM_XXX_STARTED", program);
}
inline std::string ur_stopped(const std::string& program) {
  return ur_key("PROGRAM_XXX_STOPPED", program);
}
inline std::string ur_text(const std::string& text) {
  return ur_message(0, text);
}
inline std::string ur_exception(int line, int column, const std::string& text) {
  return ur_message(
      10, big_endian(static_cast<std::uint64_t>(line), 4) + big_endian(static_cast<std::uint64_t>(column), 4) + text);
}
struct UrPicture {
  bool running = false;
  bool emergency = false;
  bool protective = false;
  int mode = 7;
  double joint = 0.5;
};
inline std::string ur_state(const UrPicture& picture = {}) {
  std::string mode = big_endian(0, 1) + std::string(8, '\1') + "\1\1\1";
  mode += static_cast<char>(picture.emergency);
  mode += static_cast<char>(picture.protective);
  mode += static_cast<char>(picture.running);
  mode += std::string(1, '\0') + static_cast<char>(picture.mode) + std::string(1 + 24 + 1, '\0');
  std::string joints = big_endian(1, 1);
  for (int i = 0; i < 6; ++i) {
    joints += big_endian(std::bit_cast<std::uint64_t>(picture.joint), 8) + std::string(32, '\0') + '\xfd';
  }
  return with_length(big_endian(16, 1) + with_length(mode) + with_length(joints));
}

/// An arm whose controller is connected and idle.
class UrFixture : public Fixture {
 public:
  explicit UrFixture(Settings settings = ur3()) : Fixture(std::move(settings)) {
    up(Channel::command);
    up(Channel::monitor);
    state();
  }
  void monitor(const std::string& packets) { hear(Channel::monitor, packets); }
  void state(const UrPicture& picture = {}) { monitor(ur_state(picture)); }
  /// A state every 0.1 s.
  void live(double time_s, const UrPicture& picture = {}) {
    for (long states = std::lround(time_s * 10); states > 0; --states) {
      wait(0.1);
      state(picture);
    }
  }
  std::string sent() { return written(Channel::command); }
};

}  // namespace trb::adapter
