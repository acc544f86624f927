// A conveyor behind Modbus for the tests: one call at a time, which the test answers like a device.
#pragma once

#include <cmath>
#include <map>

#include "common/drivers/modbus/call.hpp"
#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline Settings conveyor() {
  Settings settings = robot_settings("conveyor", "plc", Mode::direct, "modbus");
  settings.description.capabilities = {"convey"};
  settings.description.skills = {make_skill("run", "{speed}", {make_parameter("speed", ParameterType::number, "m/s")}),
                                 make_skill("reset", "")};
  settings.description.skills[0].end.kind = EndKind::state;
  settings.description.skills[0].end.state = "at_exit";
  settings.description.skills[0].end.equals = 1;
  settings.commands.values = {{"running", "coil 0"},          {"at_exit", "discrete 3"},
                              {"speed", "holding 0 * 0.001"}, {"position", "input 0 * 0.001"},
                              {"boxes", "input 1 uint32"},    {"unused", "input 99"}};
  settings.commands.commands = {{"run", "speed = {data}\nrunning = 1"},
                                {"set_speed", "speed = {data}"},
                                {"jog", "speed = {0}\nrunning = {1}"},
                                {"reset", "coil 1 = true"},
                                {"stop", "running = 0"},
                                {"release", ""}};
  settings.commands.requests = {{"speed", "speed"}, {"position", "position"}, {"boxes", "boxes"}};
  return settings;
}

/// As in a trace: "write holding 0 250" or "read input 0 x3".
inline std::string text_of(const ModbusCall& call) {
  const std::string where = std::string(name_of(call.kind)) + " " + std::to_string(call.address);
  if (!call.write) return "read " + where + " x" + std::to_string(call.count);
  std::string out = "write " + where;
  for (const auto word : call.words) out += " " + std::to_string(word);
  return out;
}

/// A conveyor's device, whose registers the test sets.
struct PlcFixture : Fixture {
  explicit PlcFixture(Settings settings = conveyor()) : Fixture(std::move(settings)) {}

  /// The calls since the last look; never more than one is unanswered.
  std::string asked() {
    std::string text;
    collect();
    for (const RobotWrite& write : robot.writes) {
      const auto call = decode_modbus_call(write.bytes);
      REQUIRE(call.has_value());
      waiting = *call;
      text += (text.empty() ? "" : "; ") + text_of(*call);
    }
    robot.writes.clear();
    return text;
  }
  void answer_call(std::uint8_t exception = 0, const std::vector<std::uint16_t>& words = {}) {
    hear(Channel::command, encode(ModbusAnswer{exception, words}));
  }
  std::vector<std::uint16_t> registers_of(const ModbusCall& call) {
    std::vector<std::uint16_t> words;
    for (int i = 0; i < (call.write ? 0 : call.count); ++i) words.push_back(memory[{call.kind, call.address + i}]);
    return words;
  }
  /// The device answers every call until there is none left at this time. Returns the writes.
  std::string serve() {
    std::string writes;
    for (std::string call = asked(); !call.empty(); call = asked()) {
      if (waiting.write) writes += (writes.empty() ? "" : "; ") + call.substr(6);
      for (std::size_t i = 0; i < waiting.words.size(); ++i) {
        memory[{waiting.kind, waiting.address + int(i)}] = waiting.words[i];
      }
      answer_call(0, registers_of(waiting));
    }
    return writes;
  }
  /// Advances time, while the device answers.
  void live(double time_s) {
    for (long left = std::lround(std::ceil(time_s / 0.05 - 1e-6)); left > 0; --left) {
      wait(0.05);
      serve();
    }
  }
  /// The skill 'run' is under way.
  void begin_run() {
    deliver(MessageType::command, order("run", R"({"speed": 0.5})"), "conveyor");
    serve();
  }
  void cancel_run() { deliver(MessageType::command, CancelExecution{attempt(), "enough"}, "conveyor"); }
  void connect() {
    up(Channel::command);
    serve();
  }

  std::map<std::pair<ModbusKind, int>, std::uint16_t> memory;
  ModbusCall waiting;
};

inline std::string online(Fixture& fixture) {
  fixture.deliver(MessageType::request, AdapterStateRequest{}, "conveyor");
  const auto states = fixture.told<AdapterState>();
  REQUIRE_FALSE(states.empty());
  return get<AdapterState>(states.back().body).robot;
}

constexpr ModbusKind kHolding = ModbusKind::holding;
constexpr ModbusKind kInput = ModbusKind::input;
constexpr ModbusKind kDiscrete = ModbusKind::discrete;

/// It has answered.
struct OnlinePlc : PlcFixture {
  OnlinePlc() { connect(); }
};

}  // namespace trb::adapter
