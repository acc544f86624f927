// A Pioneer's packets with a checksum of their own, and a robot that obeys at once.
#pragma once

#include <cmath>

#include "common/base/hex.hpp"
#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline Settings pioneer3() {
  Settings settings = robot_settings("pioneer1", "pioneer", Mode::direct, "arcos");
  settings.description.capabilities = {"mobile"};
  settings.description.frame = {1000, 180 / M_PI, {1, 3, 0, 0}};
  settings.description.skills = {
      make_skill("go_to", "[{place.x}, {place.y}, {place.yaw}]", {make_parameter("place", ParameterType::place)})};
  settings.places = {{"dock", {1, 4, 0, M_PI / 2}}};
  settings.commands.port = 8101;
  settings.commands.values = {{"position", "x y heading"}, {"battery", "battery"}, {"motors", "motors"}};
  settings.commands.commands = {{"go_to", "goto {0} {1} {2}"},
                                {"speed", "VEL {0}"},
                                {"say", "command 42 \"{data}\""},
                                {"origin", "SETO"},
                                {"relax", "ENABLE 0"},
                                {"halt", "STOP"},
                                {"stop", "STOP"},
                                {"release", "ENABLE 1"}};
  settings.commands.requests = {{"position", "position"}, {"voltage", "battery"}, {"motors", "motors"}};
  return settings;
}

/// The content of the robot's next packet.
struct Picture {
  double x = 0;
  double y = 0;
  double heading = 0;  // degrees
  int speed = 0;
  int stall = 0;
  int flags = 1;
  int battery = 125;
};

inline void put_word(Bytes& out, int value) {
  out += static_cast<char>(value & 0xff);
  out += static_cast<char>(value >> 8 & 0xff);
}

/// Computes the checksum independently, so that a mistake in arcos_checksum would show.
inline Bytes packet(const Bytes& body) {
  unsigned sum = 0;
  for (std::size_t i = 0; i < body.size(); i += 2) {
    const unsigned high = static_cast<unsigned char>(body[i]);
    if (i + 1 == body.size()) {
      sum ^= high;
    } else {
      sum += high * 256 + static_cast<unsigned char>(body[i + 1]);
    }
  }
  return "\xfa\xfb" + Bytes(1, static_cast<char>(body.size() + 2)) + body + static_cast<char>(sum >> 8 & 0xff) +
         static_cast<char>(sum & 0xff);
}

inline Bytes sip(const Picture& robot) {
  Bytes body(1, robot.speed == 0 ? '\x32' : '\x33');
  put_word(body, static_cast<int>(robot.x));
  put_word(body, static_cast<int>(robot.y));
  put_word(body, static_cast<int>(std::lround(robot.heading * 4096 / 360)));
  put_word(body, robot.speed);
  put_word(body, robot.speed);
  body += static_cast<char>(robot.battery);
  put_word(body, robot.stall);
  put_word(body, 0);
  put_word(body, robot.flags);
  body += Bytes("\x2d\x01\x03\x88\x13", 5);  // compass, one sonar reading: disc 3, 5000 mm
  return packet(body + Bytes("\0\0\0\x05\x09\x7d\0\0\0\0\0\0", 12));
}

inline std::string hex(const Bytes& bytes) {
  return to_hex(bytes);
}

/// A robot that is connected and obeys at once.
class PioneerFixture : public Fixture {
 public:
  PioneerFixture() : Fixture(pioneer3()) { welcome(); }

  void connect() {
    up(Channel::command);
    hear(Channel::command, packet(Bytes(1, '\0')));
    hear(Channel::command, packet("\x01"));
    hear(Channel::command, packet(Bytes("\x02Pio\0Pioneer\0p3dx\0", 18)));
    sip_now();
    sent();
  }
  void sip_now() { hear(Channel::command, sip(robot)); }
  /// Packets every 0.1 s.
  void live(double time_s) {
    for (auto steps = std::lround(time_s / 0.1); steps > 0; --steps) {
      wait(0.1);
      sip_now();
    }
  }
  std::string sent() { return hex(written(Channel::command)); }
  /// The next HEAD or MOVE, as a person reads it; the packets before it are skipped.
  std::string order() {
    const Bytes bytes = written(Channel::command);
    std::string words;
    for (std::size_t at = 0; at + 3 < bytes.size(); at += 3U + static_cast<unsigned char>(bytes[at + 2])) {
      if (bytes[at + 3] != 8 && bytes[at + 3] != 12) continue;
      const int size = static_cast<unsigned char>(bytes[at + 5]) + 256 * static_cast<unsigned char>(bytes[at + 6]);
      words += (bytes[at + 3] == 8 ? "MOVE " : "HEAD ") + std::to_string(bytes[at + 4] == 0x1b ? -size : size);
    }
    return words;
  }
  void execute(const std::string& place) {
    deliver(MessageType::command, adapter::order("go_to", R"({"place":")" + place + "\"}"), "pioneer1");
  }
  std::vector<RobotFault> faults() {
    std::vector<RobotFault> found;
    for (const Send& send : told<RobotFault>()) found.push_back(get<RobotFault>(send.body));
    return found;
  }

  Picture robot;
};

inline const std::string kStopPacket = "fafb031d001d";

}  // namespace trb::adapter
