// What a script asks of the robot.
#include <cmath>

#include "services/virtual-robots/ur/functions.hpp"
#include "services/virtual-robots/ur/kinematics.hpp"

namespace trb::virtual_robots::ur {
namespace {

using ParameterKind = Parameter::Kind;

template <typename Array>
std::vector<double> list_of(const Array& numbers) {
  return {numbers.begin(), numbers.end()};
}

Joints joints_in(const Value& value) {
  const auto& list = std::get<std::vector<double>>(value);
  Joints joints{};
  std::copy_n(list.begin(), kJointCount, joints.begin());
  return joints;
}

Value joint_positions(const World& world, const Bound&) {
  return list_of(world.state.joints.position);
}

Value joint_speeds(const World& world, const Bound&) {
  return list_of(world.state.joints.speed);
}

Value tcp_pose(const World& world, const Bound&) {
  return tcp_of(world.state);
}

Value flange_pose(const World& world, const Bound&) {
  return pose_of(flange_frame(world.state.joints.position));
}

Value tcp_speeds(const World& world, const Bound&) {
  return list_of(tcp_speed(world.state));
}

Value no_force(const World&, const Bound&) {
  return std::vector<double>(kJointCount, 0.0);
}

Value tool_offset(const World& world, const Bound&) {
  return world.state.tool;
}

Value steady(const World& world, const Bound&) {
  for (const double speed : world.state.joints.speed) {
    if (std::abs(speed) > 0.001) return false;
  }
  return true;
}

Value step_time(const World&, const Bound&) {
  return kStepTime;
}

/** `kFirst`: the bit of pin 0. */
template <std::uint64_t Io::*kBits, int kFirst, int kPins>
Value pin(const World& world, const Bound& bound) {
  const double number = std::get<double>(*bound[0]);
  if (!(number >= 0 && number < kPins)) throw ScriptFault{"runtime_error_no_pin:" + show(*bound[0]) + ":"};
  return ((world.state.io.*kBits >> (kFirst + static_cast<unsigned>(number))) & 1) != 0;
}

std::size_t register_index(const Value& index, int count) {
  const double number = std::get<double>(index);
  if (!(number >= 0 && number < count)) throw ScriptFault{"runtime_error_no_register:" + show(index) + ":"};
  return static_cast<std::size_t>(number);
}

template <Registers World::*kWhich>
Value read_integer(const World& world, const Bound& bound) {
  return static_cast<double>((world.*kWhich).integers[register_index(*bound[0], Registers::kNumbers)]);
}

template <Registers World::*kWhich>
Value read_float(const World& world, const Bound& bound) {
  return (world.*kWhich).doubles[register_index(*bound[0], Registers::kNumbers)];
}

template <Registers World::*kWhich>
Value read_boolean(const World& world, const Bound& bound) {
  return (world.*kWhich).bit(static_cast<int>(register_index(*bound[0], Registers::kBits)));
}

std::optional<Joints> joints_that_reach(const World& world, const Bound& bound) {
  const Frame tool = frame_of(bound[2] ? std::get<Pose>(*bound[2]) : world.state.tool);
  const Joints near = bound[1] ? joints_in(*bound[1]) : world.state.joints.position;
  return joints_for(compose(frame_of(std::get<Pose>(*bound[0])), inverse(tool)), near);
}

Value inverse_kin(const World& world, const Bound& bound) {
  const auto joints = joints_that_reach(world, bound);
  if (joints) return list_of(*joints);
  throw ScriptFault{
      "The robot cannot reach the requested pose. Script function get_inverse_kin is unable to find an inverse "
      "kinematics solution."};
}

Value has_inverse_kin(const World& world, const Bound& bound) {
  return joints_that_reach(world, bound).has_value();
}

Value forward_kin(const World& world, const Bound& bound) {
  const Joints joints = bound[0] ? joints_in(*bound[0]) : world.state.joints.position;
  return pose_of(compose(flange_frame(joints), frame_of(bound[1] ? std::get<Pose>(*bound[1]) : world.state.tool)));
}

Function telling(std::string_view name, std::vector<Parameter> parameters, Value (*tell)(const World&, const Bound&),
                 Shape::Kind gives) {
  return {name, std::move(parameters), nullptr, tell, gives, false};
}

}  // namespace

const std::vector<Function>& telling_functions() {
  using Gives = Shape::Kind;
  static const std::vector<Parameter> kPin = {{"n", ParameterKind::number, true}};
  static const std::vector<Parameter> kInverse = {
      {"x", ParameterKind::pose, true}, {"qnear", ParameterKind::six}, {"tcp", ParameterKind::pose}};
  static const std::vector<Function> kFunctions = {
      telling("get_actual_joint_positions", {}, joint_positions, Gives::list),
      telling("get_target_joint_positions", {}, joint_positions, Gives::list),
      telling("get_actual_joint_speeds", {}, joint_speeds, Gives::list),
      telling("get_target_joint_speeds", {}, joint_speeds, Gives::list),
      telling("get_actual_tcp_pose", {}, tcp_pose, Gives::pose),
      telling("get_target_tcp_pose", {}, tcp_pose, Gives::pose),
      telling("get_actual_tool_flange_pose", {}, flange_pose, Gives::pose),
      telling("get_actual_tcp_speed", {}, tcp_speeds, Gives::list),
      telling("get_target_tcp_speed", {}, tcp_speeds, Gives::list),
      telling("get_tcp_force", {}, no_force, Gives::list),
      telling("get_tcp_offset", {}, tool_offset, Gives::pose),
      telling("is_steady", {}, steady, Gives::boolean),
      telling("get_steptime", {}, step_time, Gives::number),
      telling("get_digital_in", kPin, pin<&Io::inputs, 0, 18>, Gives::boolean),
      telling("get_standard_digital_in", kPin, pin<&Io::inputs, 0, 8>, Gives::boolean),
      telling("get_digital_out", kPin, pin<&Io::outputs, 0, 18>, Gives::boolean),
      telling("get_standard_digital_out", kPin, pin<&Io::outputs, 0, 8>, Gives::boolean),
      telling("get_configurable_digital_in", kPin, pin<&Io::inputs, 8, 8>, Gives::boolean),
      telling("get_configurable_digital_out", kPin, pin<&Io::outputs, 8, 8>, Gives::boolean),
      telling("get_tool_digital_in", kPin, pin<&Io::inputs, 16, 2>, Gives::boolean),
      telling("get_tool_digital_out", kPin, pin<&Io::outputs, 16, 2>, Gives::boolean),
      telling("read_input_integer_register", kPin, read_integer<&World::inputs>, Gives::number),
      telling("read_input_float_register", kPin, read_float<&World::inputs>, Gives::number),
      telling("read_input_boolean_register", kPin, read_boolean<&World::inputs>, Gives::boolean),
      telling("read_output_integer_register", kPin, read_integer<&World::outputs>, Gives::number),
      telling("read_output_float_register", kPin, read_float<&World::outputs>, Gives::number),
      telling("read_output_boolean_register", kPin, read_boolean<&World::outputs>, Gives::boolean),
      telling("get_inverse_kin", kInverse, inverse_kin, Gives::list),
      telling("get_inverse_kin_has_solution", kInverse, has_inverse_kin, Gives::boolean),
      telling("get_forward_kin", {{"q", ParameterKind::six}, {"tcp", ParameterKind::pose}}, forward_kin, Gives::pose),
  };
  return kFunctions;
}

}  // namespace trb::virtual_robots::ur
