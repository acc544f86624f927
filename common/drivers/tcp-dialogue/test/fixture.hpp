// A robot that answers each line with one: the test reads the lines and answers as the robot would.
#pragma once

#include <cmath>

#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline Settings rover() {
  Settings settings = robot_settings("rover", "rover", Mode::direct, "tcp-dialogue");
  settings.description.capabilities = {"mobile"};
  settings.description.skills = {make_skill("drive", "[{where}]", {make_parameter("where", ParameterType::text)}),
                                 make_skill("fold", "")};
  for (Skill& skill : settings.description.skills) skill.end.kind = EndKind::acknowledgement;
  settings.commands.port = 29999;
  settings.commands.texts = {{"good", {"OK*"}}, {"bad", {"ERR*"}}, {"ignore", {"NOTE *"}}};
  settings.commands.values = {{"position", "WHERE -> AT {0} {1}"},
                              {"battery", "STATE -> {0}%, *"},
                              {"mode", "STATE -> *, {0} where IDLE=0 BUSY=1"},
                              {"unused", "UNUSED -> {0}"}};
  settings.commands.requests = {{"position", "position"}, {"battery", "battery"}, {"mode", "mode"}};
  settings.commands.commands = {{"drive", "DRIVE {0} -> ARRIVED* else LOST*"},
                                {"fold", "FOLD ARM"},
                                {"tidy", "FOLD\nPARK {0}"},
                                {"stop", "HALT"},
                                {"release", "RESUME"}};
  return settings;
}

struct RoverFixture : Fixture {
  explicit RoverFixture(Settings settings = rover()) : Fixture(std::move(settings)) {}

  /// The line since the last look; never more than one is unanswered.
  std::string asked() {
    std::string line = written(Channel::command);
    if (line.empty()) return line;
    REQUIRE(line.find('\n') == line.size() - 1);
    line.pop_back();
    return line;
  }
  void reply(const std::string& line) { hear(Channel::command, line + "\n"); }
  /// The answer to a poll; empty: it was none.
  [[nodiscard]] std::string polled(const std::string& line) const {
    if (line == "WHERE") return "AT 1.5 -2";
    return line == "STATE" ? "81%, " + mode : "";
  }
  /// The robot answers until nothing is asked; returns the lines that were no polls.
  std::string serve() {
    std::string others;
    for (std::string line = asked(); !line.empty(); line = asked()) {
      const std::string value = polled(line);
      if (value.empty()) others += (others.empty() ? "" : "; ") + line;
      reply(value.empty() ? "OK" : value);
    }
    return others;
  }
  void connect() {
    up(Channel::command);
    serve();
  }
  void live(double time_s) {
    for (long left = std::lround(std::ceil(time_s / 0.1 - 1e-6)); left > 0; --left) {
      wait(0.1);
      serve();
    }
  }
  /// The skill 'drive' is under way: the robot has answered, and drives.
  void begin_drive() {
    deliver(MessageType::command, order("drive", R"({"where": "dock"})"), "rover");
    CHECK(serve() == "DRIVE dock");
  }
  std::string robot() {
    deliver(MessageType::request, AdapterStateRequest{}, "rover");
    return get<AdapterState>(told<AdapterState>().back().body).robot;
  }

  std::string mode = "IDLE";
};

/// It has answered.
struct OnlineRover : RoverFixture {
  explicit OnlineRover(Settings settings = rover()) : RoverFixture(std::move(settings)) { connect(); }
};

}  // namespace trb::adapter
