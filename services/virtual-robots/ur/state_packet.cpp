// The state of the robot, ten times a second: the sub-packages of the maker's client interface, version 5.
#include "services/virtual-robots/ur/bytes.hpp"
#include "services/virtual-robots/ur/kinematics.hpp"
#include "services/virtual-robots/ur/packets.hpp"

namespace trb::virtual_robots::ur {
namespace {

constexpr std::uint8_t kRobotState = 16;

enum class Part : std::uint8_t {
  robot_mode = 0,
  joints = 1,
  tool = 2,
  masterboard = 3,
  cartesian = 4,
  kinematics = 5,
  configuration = 6,
  force = 7,
  additional = 8,
  calibration = 9,
  safety = 10,
  tool_communication = 11,
  tool_mode = 12
};

Bytes part_of(Part part) {
  return Bytes().u8(static_cast<std::uint8_t>(part));
}

std::string robot_mode_part(const RobotState& state, std::uint64_t time_us) {
  const bool powered = state.mode != RobotMode::power_off;
  Bytes part = part_of(Part::robot_mode);
  part.u64(time_us);
  part.u8(1).u8(1).u8(powered);
  part.u8(state.safety == SafetyMode::emergency_stop).u8(state.safety == SafetyMode::protective_stop);
  part.u8(state.program_running).u8(state.program_paused);
  part.u8(static_cast<std::uint8_t>(state.mode)).u8(0);
  // The fraction of the target speed, the speed scaling and the limit of the fraction.
  part.f64(state.speed_fraction).f64(state.program_paused ? 0.0 : 1.0).f64(1.0).u8(0);
  return part.with_length();
}

std::string joint_part(const RobotState& state) {
  Bytes part = part_of(Part::joints);
  for (std::size_t i = 0; i < kJointCount; ++i) {
    part.f64(state.joints.position[i]).f64(state.joints.position[i]).f64(state.joints.speed[i]);
    // Current, voltage, motor temperature and board temperature: plausible, always the same.
    part.f32(0.0F).f32(48.0F).f32(30.0F).f32(0.0F).u8(static_cast<std::uint8_t>(joint_mode(state.mode)));
  }
  return part.with_length();
}

std::string tool_part(const RobotState& state) {
  constexpr std::uint8_t kToolPowerOff = 239, kToolRunning = 253;
  Bytes part = part_of(Part::tool);
  part.u8(0).u8(0).f64(0).f64(0).f32(48.0F).u8(0).f32(0.0F).f32(30.0F);
  part.u8(state.mode == RobotMode::power_off ? kToolPowerOff : kToolRunning);
  return part.with_length();
}

std::string masterboard_part(const RobotState& state) {
  Bytes part = part_of(Part::masterboard);
  part.u32(static_cast<std::uint32_t>(state.io.inputs)).u32(static_cast<std::uint32_t>(state.io.outputs));
  part.u8(0).u8(0).f64(0).f64(0);
  part.u8(0).u8(0).f64(state.io.analog_outputs[0]).f64(state.io.analog_outputs[1]);
  // Temperature, the robot's voltage and current, the current of inputs and outputs.
  part.f32(35.0F).f32(48.0F).f32(0.5F).f32(0.05F);
  part.u8(static_cast<std::uint8_t>(state.safety)).u8(0).u8(0);
  // The maker's own; the inputs of the mode selector and of the enabling device; the maker's own.
  part.u32(0).u8(0).u8(0).u8(0);
  return part.with_length();
}

std::string cartesian_part(const RobotState& state) {
  return part_of(Part::cartesian).each_f64(tcp_of(state).values).each_f64(state.tool.values).with_length();
}

template <typename Member>
void put_links(Bytes& part, Member member) {
  for (const Link& link : kLinks) part.f64(link.*member);
}

std::string kinematics_part() {
  constexpr std::uint32_t kCalibrated = 0, kChecksum = 0xffffffff;
  Bytes part = part_of(Part::kinematics);
  for (std::size_t i = 0; i < kJointCount; ++i) part.u32(kChecksum);
  part.each_f64(Joints{});  // theta: no joint has an offset
  put_links(part, &Link::a);
  put_links(part, &Link::d);
  put_links(part, &Link::alpha);
  return part.u32(kCalibrated).with_length();
}

std::string configuration_part() {
  constexpr double kFast = 3.14159265358979323846, kWristFast = 2 * kFast, kAcceleration = 40;
  Bytes part = part_of(Part::configuration);
  for (std::size_t i = 0; i < kJointCount; ++i) part.f64(-kJointLimit).f64(kJointLimit);
  for (std::size_t i = 0; i < kJointCount; ++i) part.f64(i < 3 ? kFast : kWristFast).f64(kAcceleration);
  // The defaults of movej and movel: speed and acceleration of each.
  part.f64(kDefaultJointSpeed).f64(1.4).f64(kDefaultToolSpeed).f64(1.2);
  part.f64(0.1);  // equivalent radius
  put_links(part, &Link::a);
  put_links(part, &Link::d);
  put_links(part, &Link::alpha);
  part.each_f64(Joints{});
  // Master board, control box, robot (3: UR3) and its sub-type.
  part.i32(2).i32(1).i32(3).i32(1);
  return part.with_length();
}

std::string robot_parts(const RobotState& state) {
  constexpr std::size_t kSafetyBytes = 38;  // the maker's own: to be skipped
  std::string out = part_of(Part::force).each_f64(Joints{}).f64(0).with_length();
  out += part_of(Part::additional).u8(0).u8(0).u8(0).u8(0).with_length();
  out += part_of(Part::calibration).each_f64(Joints{}).with_length();
  out += part_of(Part::safety).zeros(kSafetyBytes).with_length();
  out += part_of(Part::tool_communication).u8(0).i32(115200).i32(0).i32(1).f32(1.5F).f32(3.5F).with_length();
  out += part_of(Part::tool_mode).u8(0).u8(state.io.tool_modes[0]).u8(state.io.tool_modes[1]).with_length();
  return out;
}

}  // namespace

int joint_mode(RobotMode mode) {
  constexpr int kRunning = 253, kPowerOff = 239, kIdle = 255;
  if (mode == RobotMode::running) return kRunning;
  return mode == RobotMode::idle ? kIdle : kPowerOff;
}

Pose tcp_of(const RobotState& state) {
  return pose_of(compose(flange_frame(state.joints.position), frame_of(state.tool)));
}

Twist tcp_speed(const RobotState& state) {
  const Frame flange = flange_frame(state.joints.position);
  Twist twist = twist_of(state.joints.position, state.joints.speed);
  // What the flange turns adds to the speed out there.
  const Vector arm = sum(1, compose(flange, frame_of(state.tool)).origin, -1, flange.origin);
  const Vector more = cross({twist[3], twist[4], twist[5]}, arm);
  for (std::size_t i = 0; i < 3; ++i) twist[i] += more[i];
  return twist;
}

std::string robot_state_packet(const RobotState& state, std::uint64_t time_us) {
  Bytes packet;
  packet.u8(kRobotState).text(robot_mode_part(state, time_us)).text(joint_part(state)).text(tool_part(state));
  packet.text(masterboard_part(state)).text(cartesian_part(state)).text(kinematics_part());
  packet.text(configuration_part()).text(robot_parts(state));
  return packet.with_length();
}

}  // namespace trb::virtual_robots::ur
