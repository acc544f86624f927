#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "services/virtual-robots/ur/arm.hpp"

namespace trb::virtual_robots::ur {

enum class RobotMode : std::uint8_t { PowerOff = 3, Idle = 5, Running = 7 };

enum class SafetyMode : std::uint8_t { Normal = 1, ProtectiveStop = 3, EmergencyStop = 7 };

enum class ErrorLevel : std::uint8_t { Warning = 2, Violation = 3, Fault = 4 };

/** The contents of a RobotState packet. */
struct RobotState {
  RobotMode mode = RobotMode::Running;
  SafetyMode safety = SafetyMode::Normal;
  bool program_running = false;
  bool program_paused = false;
  double speed_fraction = 1;
  JointState joints;
  Pose tool;              ///< from the flange to the tool's centre
};

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
