// Reads the primary interface of Universal Robots controllers (port 30001 or its read-only twin): big-endian packets
// `int32 length, uint8 type`.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb::drivers {

// Safety codes as the controller numbers them.
constexpr int kUrSafetyNormal = 1;
constexpr int kUrSafetyProtectiveStop = 3;
constexpr int kUrSafetyEmergencyStop = 7;

// Robot modes in which nothing is carried out, and the one in which programs run.
constexpr int kUrModePowerOff = 3;
constexpr int kUrModeIdle = 5;
constexpr int kUrModeRunning = 7;

/// From the shoulder no tool's centre is farther away than this, whatever the joints: an upper bound, in metres.
struct UrReach {
  double shoulder_height = 0;
  double length = 0;
};

struct UrState {
  int robot_mode = 0;
  int safety = kUrSafetyNormal;
  bool program_running = false;
  bool power = false;
  double speed_fraction = 1;  ///< of the speed slider
  std::optional<std::array<double, 6>> joints;
  std::optional<std::array<double, 6>> tool;  ///< where its centre is: x y z in metres, and a rotation vector
  double tool_length = 0;                     ///< from the flange to the tool's centre, in metres
  std::optional<UrReach> reach;
};
struct UrProgramStarted {
  std::string name;
};
struct UrProgramStopped {
  std::string name;
};
struct UrText {
  std::string text;
};
struct UrException {
  std::int32_t line = 0;
  std::int32_t column = 0;
  std::string text;
};
struct UrError {
  std::int32_t code = 0;
  std::int32_t argument = 0;
  std::int32_t level = 0;
  std::string text;
};
using UrEvent = std::variant<UrState, UrProgramStarted, UrProgramStopped, UrText, UrException, UrError>;

class UrMonitor {
 public:
  /// Takes bytes as they arrive; packets of unknown or broken content are skipped. An error (malformed, too_large)
  /// means that the packet borders are lost.
  Status add(BytesView bytes, std::vector<UrEvent>& events);
  void clear() { buffer_.clear(); }

 private:
  Bytes buffer_;
};

}  // namespace trb::drivers
