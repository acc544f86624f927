// A KUKA for the tests of the C3 mode: variables behind a C3 server, and a program controlled by the test.
#pragma once

#include <cmath>
#include <map>

#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline Settings kuka() {
  Settings settings = robot_settings("kuka", "kuka", Mode::direct, "c3");
  settings.description.capabilities = {"grab", "reach"};
  settings.description.has_field_channel = true;
  settings.description.field_channel.chunk_bytes = 16;
  Parameter joints = make_parameter("joints", ParameterType::numbers, "rad");
  joints.count = 2;
  settings.description.skills = {make_skill("reach", "{joints}", {joints}), make_skill("home", "")};
  settings.description.skills[0].subtype = "move";
  settings.commands.port = 7000;
  settings.commands.commands = {
      {"move", "TRB_AXIS = {E6AXIS: A1 {0}, A2 {1}}"}, {"stop", "TRB_STOP = TRUE"}, {"release", "TRB_STOP = FALSE"}};
  settings.commands.values = {{"position", "$POS_ACT X Y"}, {"pose", "$POS_ACT"}};
  settings.commands.requests = {{"position", "position"}, {"pose", "pose"}};
  return settings;
}

class C3Fixture : public Fixture {
 public:
  explicit C3Fixture(Settings settings = kuka()) : Fixture(std::move(settings)) {
    for (const char* flag :
         {"TRB_CHUNK", "TRB_COMMAND", "TRB_DONE", "TRB_OUT", "TRB_STOP", "TRB_STOPPED", "$STOPMESS"}) {
      robot[flag] = "FALSE";
    }
    for (const char* text : {"TRB_TYPE[]", "TRB_SUBTYPE[]", "TRB_SOURCE[]", "TRB_DATA[]", "TRB_TEXT[]", "TRB_ERROR[]",
                             "TRB_OUT_TYPE[]", "TRB_OUT_SUBTYPE[]", "TRB_OUT_TARGET[]", "TRB_OUT_DATA[]"}) {
      robot[text] = "\"\"";
    }
    for (const char* count : {"TRB_SIZE", "TRB_NUMBER", "TRB_DONE_NUMBER", "TRB_RESULT", "TRB_OUT_SIZE"}) {
      robot[count] = "0";
    }
    robot["TRB_AXIS"] = "{E6AXIS: A1 0.0}";
    robot["$POS_ACT"] = "{E6POS: X 10.5, Y -2.0E1, Z 3}";
    up(Channel::command);
    serve();
  }

  /// The robot answers every request until there is none left.
  void serve() {
    while (serve_one()) {
    }
  }
  /// The robot answers the oldest request. False: there is none.
  bool serve_one() {
    asked_ += written(Channel::command);
    if (asked_.size() < 4) return false;
    const auto u16 = [&](std::size_t at) {
      return static_cast<std::size_t>(static_cast<unsigned char>(asked_[at])) * 256 +
             static_cast<unsigned char>(asked_[at + 1]);
    };
    const std::string tag = asked_.substr(0, 2);
    const std::size_t length = u16(2);
    const bool write = asked_[4] == 1;
    const std::string name = asked_.substr(7, u16(5));
    const auto found = robot.find(name);
    if (write && found != robot.end()) {
      found->second = asked_.substr(7 + name.size() + 2, u16(7 + name.size()));
      writes_ += name + "=" + found->second + "\n";
    }
    asked_.erase(0, 4 + length);
    const std::string value = found == robot.end() ? "" : found->second;
    const std::string footer = found == robot.end() ? std::string(3, '\0') : std::string("\0\1\1", 3);
    const std::string body = std::string(1, write ? '\1' : '\0') + big_endian(value.size(), 2) + value + footer;
    hear(Channel::command, tag + big_endian(body.size(), 2) + body);
    return true;
  }
  /// Advances time; the robot answers at once.
  void live(double time_s) {
    for (auto steps = std::lround(time_s / 0.05); steps > 0; --steps) {
      wait(0.05);
      serve();
    }
  }
  /// The program takes the offered message.
  void take() {
    live(0.1);
    CHECK(robot["TRB_COMMAND"] == "TRUE");
    robot["TRB_COMMAND"] = "FALSE";
    number = robot["TRB_NUMBER"];
    live(0.1);
  }
  /// The skill 'home' is under way.
  void begin_home() {
    deliver(MessageType::request, order("home", ""), "kuka");
    take();
  }
  void cancel() { deliver(MessageType::command, CancelExecution{attempt(), "enough"}, "kuka"); }
  /// The program takes a command: its answer.
  std::string take_command() {
    const auto id = command("wave", "1");
    take();
    return answer(id);
  }
  void finish(int result = 0, const std::string& text = "") {
    robot["TRB_DONE_NUMBER"] = number;
    robot["TRB_RESULT"] = std::to_string(result);
    robot["TRB_TEXT[]"] = '"' + text + '"';
    robot["TRB_DONE"] = "TRUE";
    live(0.2);
  }
  std::string writes() { return std::exchange(writes_, {}); }

  std::map<std::string, std::string> robot;
  std::string number;

 private:
  std::string asked_;
  std::string writes_;
};

}  // namespace trb::adapter
