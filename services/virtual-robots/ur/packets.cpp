#include "services/virtual-robots/ur/packets.hpp"

#include <bit>

namespace trb::virtual_robots::ur {
namespace {

constexpr std::uint8_t kRobotState = 16;
constexpr std::uint8_t kRobotMessage = 20;

/** Sources of a message: the controller's interface and its real-time part. */
constexpr std::uint8_t kSourceInterface = 0xfe;
constexpr std::uint8_t kSourceRealTime = 0xfd;

enum class MessageKind : std::uint8_t { Text = 0, Version = 3, Safety = 5, Error = 6, Key = 7, Exception = 10 };

/** Appends numbers in network order. */
class Bytes {
 public:
  Bytes& u8(std::uint8_t value) { return put(value, 1); }
  Bytes& u32(std::uint32_t value) { return put(value, 4); }
  Bytes& i32(std::int32_t value) { return u32(static_cast<std::uint32_t>(value)); }
  Bytes& u64(std::uint64_t value) { return put(value, 8); }
  Bytes& f32(float value) { return u32(std::bit_cast<std::uint32_t>(value)); }
  Bytes& f64(double value) { return u64(std::bit_cast<std::uint64_t>(value)); }
  Bytes& text(std::string_view value) {
    bytes_ += value;
    return *this;
  }

  /** The bytes preceded by their length, which includes itself. */
  std::string with_length() const { return Bytes().u32(static_cast<std::uint32_t>(bytes_.size() + 4)).bytes_ + bytes_; }

 private:
  Bytes& put(std::uint64_t value, int count) {
    for (int shift = 8 * (count - 1); shift >= 0; shift -= 8) bytes_ += static_cast<char>((value >> shift) & 0xff);
    return *this;
  }

  std::string bytes_;
};

Bytes message(MessageKind kind, std::uint64_t time_us) {
  Bytes bytes;
  bytes.u8(kRobotMessage).u64(time_us).u8(kSourceRealTime).u8(static_cast<std::uint8_t>(kind));
  return bytes;
}

std::string robot_mode_part(const RobotState& state, std::uint64_t time_us) {
  const bool powered = state.mode != RobotMode::PowerOff;
  Bytes part;
  part.u8(0).u64(time_us);
  part.u8(1).u8(1).u8(powered);
  part.u8(state.safety == SafetyMode::EmergencyStop).u8(state.safety == SafetyMode::ProtectiveStop);
  part.u8(state.program_running).u8(state.program_paused);
  part.u8(static_cast<std::uint8_t>(state.mode)).u8(0);
  // The fraction of the target speed, the speed scaling and the limit of the fraction.
  part.f64(state.speed_fraction).f64(state.program_paused ? 0.0 : 1.0).f64(1.0).u8(0);
  return part.with_length();
}

std::uint8_t joint_mode(RobotMode mode) {
  constexpr std::uint8_t kRunning = 253, kPowerOff = 239, kIdle = 255;
  if (mode == RobotMode::Running) return kRunning;
  return mode == RobotMode::Idle ? kIdle : kPowerOff;
}

std::string joint_part(const RobotState& state) {
  Bytes part;
  part.u8(1);
  for (std::size_t i = 0; i < kJointCount; ++i) {
    part.f64(state.joints.position[i]).f64(state.joints.position[i]).f64(state.joints.speed[i]);
    // Current, voltage, motor temperature and board temperature: plausible, always the same.
    part.f32(0.0F).f32(48.0F).f32(30.0F).f32(0.0F).u8(joint_mode(state.mode));
  }
  return part.with_length();
}

}  // namespace

std::string version_packet() {
  constexpr std::string_view kProject = "URControl";
  Bytes bytes;
  bytes.u8(kRobotMessage)
      .u64(~std::uint64_t{0})
      .u8(kSourceInterface)
      .u8(static_cast<std::uint8_t>(MessageKind::Version));
  bytes.u8(static_cast<std::uint8_t>(kProject.size())).text(kProject);
  // Major, minor, bug fix, build number, then the date up to the end.
  bytes.u8(5).u8(12).i32(0).i32(0).text("01-01-2022, 00:00:00");
  return bytes.with_length();
}

std::string robot_state_packet(const RobotState& state, std::uint64_t time_us) {
  return Bytes().u8(kRobotState).text(robot_mode_part(state, time_us)).text(joint_part(state)).with_length();
}

std::string text_packet(std::string_view text, std::uint64_t time_us) {
  return message(MessageKind::Text, time_us).text(text).with_length();
}

std::string safety_packet(SafetyMode mode, std::uint64_t time_us) {
  Bytes bytes = message(MessageKind::Safety, time_us);
  bytes.i32(0).i32(0).u8(static_cast<std::uint8_t>(mode)).u32(0).u32(0);
  return bytes.with_length();
}

std::string error_packet(std::int32_t code, std::int32_t argument, ErrorLevel level, std::string_view text,
                         std::uint64_t time_us) {
  Bytes bytes = message(MessageKind::Error, time_us);
  bytes.i32(code).i32(argument).i32(static_cast<std::int32_t>(level)).u32(0).u32(0).text(text);
  return bytes.with_length();
}

std::string key_packet(std::string_view title, std::string_view text, std::uint64_t time_us) {
  Bytes bytes = message(MessageKind::Key, time_us);
  bytes.i32(0).i32(0).u8(static_cast<std::uint8_t>(title.size())).text(title).text(text);
  return bytes.with_length();
}

std::string exception_packet(const ScriptError& error, std::uint64_t time_us) {
  return message(MessageKind::Exception, time_us).i32(error.line).i32(error.column).text(error.text).with_length();
}

}  // namespace trb::virtual_robots::ur
