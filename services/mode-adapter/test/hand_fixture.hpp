// A cart that is driven by hand: the next message of a drive, and what is written to the cart.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline Drive base_drive(const std::string& data) {
  Drive drive;
  drive.part = DrivePart::base;
  drive.axes = {{"x", 0.5, false, {}}, {"yaw", 1, false, {}}};
  drive.command = make_skill(
      "drive", data,
      {make_parameter("x", ParameterType::number, "m/s"), make_parameter("yaw", ParameterType::number, "rad/s")});
  return drive;
}

/// A robot of a maker that takes every line at once (tcp-text without a monitor): what is written has left.
inline Settings driven_cart() {
  Settings settings = robot_settings("cart", "acme", Mode::direct, "tcp-text");
  settings.description.capabilities = {"mobile"};
  settings.description.skills = {make_skill("home", "")};
  settings.description.skills[0].end.kind = EndKind::time;
  settings.description.skills[0].end.duration_s = 5;
  settings.description.drives = {base_drive("[{x}, {yaw}]")};
  settings.description.frame.length = 1000;
  settings.commands.port = 30100;
  settings.commands.commands = {
      {"drive", "SPEED {0} {1}"}, {"go", "GO {data}"}, {"home", "HOME"}, {"stop", "HALT"}, {"release", ""}};
  return settings;
}

struct HandFixture : Fixture {
  explicit HandFixture(Settings settings = driven_cart()) : Fixture(std::move(settings)) {
    up(Channel::command);
    welcome();
    out.clear();
  }
  /// A drive's next message; its answer.
  std::string drive(std::vector<double> speeds, Velocity how = {}, const std::string& source = "cloud") {
    how.part = how.part == DrivePart::base ? part : how.part;
    how.speeds = std::move(speeds);
    if (how.drive == 0) how.drive = 1;
    if (how.sequence == 0) how.sequence = ++sequence;
    if (how.by.empty()) how.by = "ada";
    return answer(deliver(MessageType::command, how, source));
  }
  std::string let_go(std::uint64_t number = 1, const std::string& source = "cloud") {
    Velocity how;
    how.drive = number;
    how.over = true;
    return drive({}, how, source);
  }
  Velocity another(std::uint64_t number, bool take = false, const std::string& by = "bob") {
    Velocity how;
    how.drive = number;
    how.take = take;
    how.by = by;
    return how;
  }
  std::string sent() { return written(Channel::command); }
  Nack why() { return nack_of(last_id); }
  std::string control() {
    const auto profiles = told<NodeProfile>();
    return profiles.empty() ? "?" : get<NodeProfile>(profiles.back().body).control;
  }

  DrivePart part = DrivePart::base;
  std::uint64_t sequence = 0;
};

}  // namespace trb::adapter
