#include <algorithm>
#include <cmath>

#include "services/virtual-robots/support/text.hpp"
#include "services/virtual-robots/ur/rtde_registers.hpp"

namespace trb::virtual_robots::ur {
namespace {

using P = const RtdePicture&;

std::uint32_t runtime_state(const RobotState& state) {
  constexpr std::uint32_t kStopped = 1, kPlaying = 2, kPaused = 4;
  return state.program_running ? kPlaying : state.program_paused ? kPaused : kStopped;
}

std::uint32_t status_bits(const RobotState& state) {
  const std::uint32_t powered = state.mode != RobotMode::power_off ? 1 : 0;
  return powered | (state.program_running ? 2 : 0);
}

std::uint32_t safety_bits(SafetyMode mode) {
  constexpr std::uint32_t kNormal = 1, kProtective = 1 << 2, kRobotStop = 1 << 6, kEmergency = 1 << 7,
                          kStopped = 1 << 10;
  if (mode == SafetyMode::normal) return kNormal;
  return kStopped | (mode == SafetyMode::protective_stop ? kProtective : kRobotStop | kEmergency);
}

void six(Bytes& out, double value) {
  for (std::size_t i = 0; i < kJointCount; ++i) out.f64(value);
}

struct OutputRow {
  std::string_view name;
  RtdeType type;
  void (*put)(const RtdePicture& picture, int index, Bytes& out);
};

void no_vector6(P, int, Bytes& out) {
  six(out, 0);
}
void no_vector3(P, int, Bytes& out) {
  out.f64(0).f64(0).f64(0);
}
void no_double(P, int, Bytes& out) {
  out.f64(0);
}
void no_word(P, int, Bytes& out) {
  out.u32(0);
}

constexpr OutputRow kMotion[] = {
    {"timestamp", RtdeType::double_, [](P p, int, Bytes& out) { out.f64(p.time); }},
    {"target_q", RtdeType::vector6d, [](P p, int, Bytes& out) { out.each_f64(p.state.joints.position); }},
    {"target_qd", RtdeType::vector6d, [](P p, int, Bytes& out) { out.each_f64(p.state.joints.speed); }},
    {"target_qdd", RtdeType::vector6d, no_vector6},
    {"target_current", RtdeType::vector6d, no_vector6},
    {"target_moment", RtdeType::vector6d, no_vector6},
    {"actual_q", RtdeType::vector6d, [](P p, int, Bytes& out) { out.each_f64(p.state.joints.position); }},
    {"actual_qd", RtdeType::vector6d, [](P p, int, Bytes& out) { out.each_f64(p.state.joints.speed); }},
    {"actual_current", RtdeType::vector6d, no_vector6},
    {"joint_control_output", RtdeType::vector6d, no_vector6},
    {"actual_TCP_pose", RtdeType::vector6d, [](P p, int, Bytes& out) { out.each_f64(tcp_of(p.state).values); }},
    {"actual_TCP_speed", RtdeType::vector6d, [](P p, int, Bytes& out) { out.each_f64(tcp_speed(p.state)); }},
    {"actual_TCP_force", RtdeType::vector6d, no_vector6},
    {"target_TCP_pose", RtdeType::vector6d, [](P p, int, Bytes& out) { out.each_f64(tcp_of(p.state).values); }},
    {"target_TCP_speed", RtdeType::vector6d, [](P p, int, Bytes& out) { out.each_f64(tcp_speed(p.state)); }},
    {"elbow_position", RtdeType::vector3d,
     [](P p, int, Bytes& out) { out.each_f64(elbow_of(p.state.joints.position)); }},
    {"tcp_offset", RtdeType::vector6d, [](P p, int, Bytes& out) { out.each_f64(p.state.tool.values); }},
    {"speed_scaling", RtdeType::double_, [](P p, int, Bytes& out) { out.f64(p.state.program_paused ? 0 : 1); }},
    {"target_speed_fraction", RtdeType::double_, [](P p, int, Bytes& out) { out.f64(p.state.speed_fraction); }},
    {"actual_tool_accelerometer", RtdeType::vector3d, no_vector3},
    {"actual_momentum", RtdeType::double_, no_double},
    {"tcp_force_scalar", RtdeType::double_, no_double},
    {"ft_raw_wrench", RtdeType::vector6d, no_vector6},
    {"payload", RtdeType::double_, no_double},
    {"payload_inertia", RtdeType::vector6d, no_vector6},
    {"elbow_velocity", RtdeType::vector3d, no_vector3},
    {"script_control_line", RtdeType::uint32, no_word},
    {"payload_cog", RtdeType::vector3d, no_vector3},
};

constexpr OutputRow kModes[] = {
    {"robot_mode", RtdeType::int32, [](P p, int, Bytes& out) { out.i32(static_cast<std::int32_t>(p.state.mode)); }},
    {"joint_mode", RtdeType::vector6_int32,
     [](P p, int, Bytes& out) {
       for (std::size_t i = 0; i < kJointCount; ++i) out.i32(joint_mode(p.state.mode));
     }},
    {"safety_mode", RtdeType::int32, [](P p, int, Bytes& out) { out.i32(static_cast<std::int32_t>(p.state.safety)); }},
    {"safety_status", RtdeType::int32,
     [](P p, int, Bytes& out) { out.i32(static_cast<std::int32_t>(p.state.safety)); }},
    {"runtime_state", RtdeType::uint32, [](P p, int, Bytes& out) { out.u32(runtime_state(p.state)); }},
    {"robot_status_bits", RtdeType::uint32, [](P p, int, Bytes& out) { out.u32(status_bits(p.state)); }},
    {"safety_status_bits", RtdeType::uint32, [](P p, int, Bytes& out) { out.u32(safety_bits(p.state.safety)); }},
};

constexpr OutputRow kElectric[] = {
    {"actual_digital_input_bits", RtdeType::uint64, [](P p, int, Bytes& out) { out.u64(p.state.io.inputs); }},
    {"actual_digital_output_bits", RtdeType::uint64, [](P p, int, Bytes& out) { out.u64(p.state.io.outputs); }},
    {"standard_analog_input0", RtdeType::double_, no_double},
    {"standard_analog_input1", RtdeType::double_, no_double},
    {"standard_analog_output0", RtdeType::double_, [](P p, int, Bytes& out) { out.f64(p.state.io.analog_outputs[0]); }},
    {"standard_analog_output1", RtdeType::double_, [](P p, int, Bytes& out) { out.f64(p.state.io.analog_outputs[1]); }},
    {"analog_io_types", RtdeType::uint32, no_word},
    {"euromap67_input_bits", RtdeType::uint32, no_word},
    {"euromap67_output_bits", RtdeType::uint32, no_word},
    {"euromap67_24V_voltage", RtdeType::double_, no_double},
    {"euromap67_24V_current", RtdeType::double_, no_double},
    {"io_current", RtdeType::double_, [](P, int, Bytes& out) { out.f64(0.05); }},
    {"tool_mode", RtdeType::uint32,
     [](P p, int, Bytes& out) { out.u32(p.state.mode == RobotMode::power_off ? 239 : 253); }},
    {"tool_analog_input_types", RtdeType::uint32, no_word},
    {"tool_analog_input0", RtdeType::double_, no_double},
    {"tool_analog_input1", RtdeType::double_, no_double},
    {"tool_output_voltage", RtdeType::int32, no_word},
    {"tool_output_current", RtdeType::double_, no_double},
    {"tool_temperature", RtdeType::double_, [](P, int, Bytes& out) { out.f64(30); }},
    {"tool_output_mode", RtdeType::uint8, [](P, int, Bytes& out) { out.u8(0); }},
    {"tool_digital_output0_mode", RtdeType::uint8, [](P p, int, Bytes& out) { out.u8(p.state.io.tool_modes[0]); }},
    {"tool_digital_output1_mode", RtdeType::uint8, [](P p, int, Bytes& out) { out.u8(p.state.io.tool_modes[1]); }},
    {"joint_temperatures", RtdeType::vector6d, [](P, int, Bytes& out) { six(out, 30); }},
    {"actual_joint_voltage", RtdeType::vector6d, [](P, int, Bytes& out) { six(out, 48); }},
    {"actual_main_voltage", RtdeType::double_, [](P, int, Bytes& out) { out.f64(48); }},
    {"actual_robot_voltage", RtdeType::double_, [](P, int, Bytes& out) { out.f64(48); }},
    {"actual_robot_current", RtdeType::double_, [](P, int, Bytes& out) { out.f64(0.5); }},
    {"actual_execution_time", RtdeType::double_, [](P, int, Bytes& out) { out.f64(0.2); }},
};

template <std::size_t Count>
std::optional<RtdeOutput> found_in(const OutputRow (&rows)[Count], std::string_view name) {
  const auto* row =
      std::find_if(std::begin(rows), std::end(rows), [&](const OutputRow& each) { return each.name == name; });
  if (row == std::end(rows)) return std::nullopt;
  return RtdeOutput{row->type, row->put, 0};
}

const Registers& registers_of(const RtdePicture& picture, bool inputs) {
  return inputs ? picture.inputs : picture.outputs;
}

template <bool kInputs>
std::optional<RtdeOutput> register_output(const RegisterName& name) {
  switch (name.kind) {
    case RegisterName::Kind::word:
      return RtdeOutput{RtdeType::uint32,
                        [](P p, int i, Bytes& out) { out.u32(registers_of(p, kInputs).bits[std::size_t(i)]); },
                        name.index};
    case RegisterName::Kind::bit:
      return RtdeOutput{RtdeType::bool_,
                        [](P p, int i, Bytes& out) { out.u8(registers_of(p, kInputs).bit(i) ? 1 : 0); }, name.index};
    case RegisterName::Kind::integer:
      return RtdeOutput{RtdeType::int32,
                        [](P p, int i, Bytes& out) { out.i32(registers_of(p, kInputs).integers[std::size_t(i)]); },
                        name.index};
    case RegisterName::Kind::double_:
      return RtdeOutput{RtdeType::double_,
                        [](P p, int i, Bytes& out) { out.f64(registers_of(p, kInputs).doubles[std::size_t(i)]); },
                        name.index};
  }
  return std::nullopt;
}

}  // namespace

std::optional<RtdeOutput> rtde_output(std::string_view name) {
  if (auto found = found_in(kMotion, name)) return found;
  if (auto found = found_in(kModes, name)) return found;
  if (auto found = found_in(kElectric, name)) return found;
  if (const auto input = register_name(name, "input_")) return register_output<true>(*input);
  if (const auto output = register_name(name, "output_")) return register_output<false>(*output);
  return std::nullopt;
}

std::string_view name_of(RtdeType type) {
  constexpr std::string_view kNames[] = {"VECTOR6D", "VECTOR3D", "VECTOR6INT32", "VECTOR6UINT32", "DOUBLE",
                                         "UINT64",   "UINT32",   "INT32",        "BOOL",          "UINT8"};
  return kNames[static_cast<std::size_t>(type)];
}

std::size_t size_of(RtdeType type) {
  constexpr std::size_t kSizes[] = {48, 24, 24, 24, 8, 8, 4, 4, 1, 1};
  return kSizes[static_cast<std::size_t>(type)];
}

}  // namespace trb::virtual_robots::ur
