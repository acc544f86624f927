// An AR.Drone 2 whose navdata is received, for tests.
#pragma once

#include <cmath>
#include <numeric>
#include <sstream>

#include "services/mode-adapter/test/fixture.hpp"

namespace trb::adapter {

inline std::string little_endian(std::uint64_t value, int size) {
  std::string out;
  for (int i = 0; i < size; ++i) out += static_cast<char>((value >> (8 * i)) & 0xffU);
  return out;
}
inline std::string little_float(float value) {
  return little_endian(std::bit_cast<std::uint32_t>(value), 4);
}

/// The content of one navdata datagram.
struct Sky {
  unsigned control = 2;  ///< landed
  bool flying = false;
  unsigned bits = 0;  ///< others of the state
  int battery = 76;
  float vx = 0, vy = 0, vz = 0;  ///< mm/s
  bool demo = true;
};
constexpr Sky kOnGround{};
constexpr Sky kTakingOff{.control = 6, .flying = true};
constexpr Sky kHovering{.control = 4, .flying = true};
constexpr Sky kLanding{.control = 8, .flying = true};
constexpr unsigned kEmergencyBit = 1U << 31;
constexpr unsigned kCutoutBit = 1U << 22;
constexpr unsigned kBatteryLowBit = 1U << 15;
constexpr unsigned kWatchdogBit = 1U << 30;
constexpr unsigned kCommandBit = 1U << 6;

inline std::string with_checksum(const std::string& packet) {
  const auto sum = std::accumulate(packet.begin(), packet.end(), std::uint32_t{0},
                                   [](std::uint32_t so_far, char c) { return so_far + static_cast<unsigned char>(c); });
  return packet + little_endian(0xffff, 2) + little_endian(8, 2) + little_endian(sum, 4);
}
inline std::string navdata(std::uint32_t sequence, const Sky& sky) {
  std::string out = little_endian(0x55667788, 4) + little_endian((sky.flying ? 1U : 0U) | sky.bits, 4) +
                    little_endian(sequence, 4) + little_endian(0, 4);
  if (!sky.demo) return with_checksum(out);
  std::string demo = little_endian(0, 2) + little_endian(148, 2) + little_endian(sky.control << 16U, 4) +
                     little_endian(static_cast<std::uint32_t>(sky.battery), 4) + little_float(-1000) +
                     little_float(2000) + little_float(90000) + little_endian(812, 4) + little_float(sky.vx) +
                     little_float(sky.vy) + little_float(sky.vz);
  demo.resize(148, '\0');
  return with_checksum(out + demo);
}

inline Settings drone() {
  Settings settings = robot_settings("drone", "ardrone", Mode::direct, "udp-at");
  settings.description.capabilities = {"fly"};
  settings.commands.port = 5556;
  settings.commands.monitor = Monitor{"ar-navdata", 5554};
  settings.commands.commands = {{"take_off", "REF take_off"},
                                {"land", "REF land"},
                                {"hover", "hover for {data}"},
                                {"move", "PCMD {0} {1} {2} {3} for {4}"},
                                {"nudge", "PCMD 0 -0.8 0 0"},
                                {"stop", "hover"},
                                {"release", ""},
                                {"emergency", "REF emergency"},
                                {"recover", "REF recover"},
                                {"trim", "FTRIM"},
                                {"name", "CONFIG \"general:ardrone_name\" {data}"},
                                {"lights", "LED {0} {1} {2}"}};
  settings.commands.requests = {{"battery", "battery"}, {"height", "up"}, {"state", "state"}, {"yaw", "yaw"}};
  settings.commands.values = {{"up", "altitude"}};
  Parameter duration = make_parameter("duration", ParameterType::number, "s");
  settings.description.skills = {make_skill("take_off", ""), make_skill("land", ""),
                                 make_skill("hover", "{duration}", {duration})};
  for (Skill& skill : settings.description.skills) skill.capability = "fly";
  return settings;
}

class DroneFixture : public Fixture {
 public:
  explicit DroneFixture(const Sky& first = kOnGround, Settings settings = drone())
      : Fixture(std::move(settings)), sky(first) {
    up(Channel::command);
    up(Channel::monitor);
    tell(sky);
    wait(0);
    sent();
    written(Channel::monitor);
  }
  void tell(const Sky& picture) {
    sky = picture;
    hear(Channel::monitor, navdata(++sequence, sky));
  }
  /// Navdata 15 times a second, always with the same content.
  void live(double time_s, const Sky& picture) {
    for (auto steps = std::lround(time_s / 0.0625); steps > 0; --steps) {
      wait(0.0625);
      tell(picture);
    }
  }
  std::uint64_t execute(const std::string& skill, const std::string& data = {}) {
    return deliver(MessageType::command, order(skill, data), "drone");
  }
  /// What was sent, each command as "NAME,ARGUMENTS", without the sequence numbers, which must rise by one.
  std::vector<std::string> sent() {
    std::vector<std::string> calls;
    std::istringstream lines(written(Channel::command));
    for (std::string line; std::getline(lines, line, '\r');) {
      REQUIRE(line.starts_with("AT*"));
      const std::size_t equals = line.find('=');
      const std::size_t end = std::min(line.find(',', equals), line.size());
      CHECK(line.substr(equals + 1, end - equals - 1) == std::to_string(++last_sent));
      calls.push_back(line.substr(3, equals - 3) + line.substr(end));
    }
    return calls;
  }
  /// The last of that name that was sent.
  std::string last(const std::string& name) {
    std::string found;
    for (const std::string& call : sent()) {
      if (call.starts_with(name)) found = call;
    }
    return found;
  }
  std::vector<RobotFault> faults() {
    std::vector<RobotFault> found;
    for (const Send& send : told<RobotFault>()) found.push_back(get<RobotFault>(send.body));
    return found;
  }

  Sky sky;
  std::uint32_t sequence = 0;
  std::uint32_t last_sent = 0;
};

// REF as the drone knows it: on the ground, in the air, with the emergency bit.
constexpr const char* kRefGround = "REF,290717696";
constexpr const char* kRefAir = "REF,290718208";
constexpr const char* kRefToggle = "REF,290717952";
constexpr const char* kHoverCall = "PCMD,0,0,0,0,0";

}  // namespace trb::adapter
