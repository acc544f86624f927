#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "services/virtual-robots/ur/arm.hpp"

namespace trb::virtual_robots::ur {

enum class RobotMode : std::uint8_t { power_off = 3, idle = 5, running = 7 };

enum class SafetyMode : std::uint8_t { normal = 1, protective_stop = 3, emergency_stop = 7 };

enum class ErrorLevel : std::uint8_t { warning = 2, violation = 3, fault = 4 };

/** Digital inputs and outputs: bits 0 to 7 standard, 8 to 15 configurable, 16 and 17 the tool's. */
struct Io {
  std::uint64_t inputs = 0;
  std::uint64_t outputs = 0;
  std::array<double, 2> analog_outputs{};    ///< 0 to 1 of the range
  std::array<std::uint8_t, 2> tool_modes{};  ///< of the tool's digital outputs
};

/** The contents of a RobotState packet. */
struct RobotState {
  RobotMode mode = RobotMode::running;
  SafetyMode safety = SafetyMode::normal;
  bool program_running = false;
  bool program_paused = false;
  double speed_fraction = 1;
  JointState joints;
  Io io;
  Pose tool;  ///< from the flange to the tool's centre
};

/** What one joint says of itself, as the maker numbers it. */
int joint_mode(RobotMode mode);
/** Where the tool's centre is. */
Pose tcp_of(const RobotState& state);
/** How the tool's centre moves. */
Twist tcp_speed(const RobotState& state);

// Each function returns one complete packet, big-endian, its length first. `time_us` is in microseconds.

std::string version_packet();
std::string robot_state_packet(const RobotState& state, std::uint64_t time_us);
std::string text_packet(std::string_view text, std::uint64_t time_us);
std::string safety_packet(SafetyMode mode, std::uint64_t time_us);
std::string error_packet(std::int32_t code, std::int32_t argument, ErrorLevel level, std::string_view text,
                         std::uint64_t time_us);
std::string key_packet(std::string_view title, std::string_view text, std::uint64_t time_us);
std::string exception_packet(const ScriptError& error, std::uint64_t time_us);

}  // namespace trb::virtual_robots::ur
