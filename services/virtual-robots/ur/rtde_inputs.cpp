#include <algorithm>
#include <cmath>

#include "services/virtual-robots/support/text.hpp"
#include "services/virtual-robots/ur/rtde_registers.hpp"

namespace trb::virtual_robots::ur {
namespace {

using W = RtdeWritten&;

struct InputRow {
  std::string_view name;
  RtdeType type;
  void (*take)(Reader& in, int index, RtdeWritten& into);
};

/** A number that is none counts as nothing written. */
double finite(double value, double otherwise) {
  return std::isfinite(value) ? value : otherwise;
}

constexpr InputRow kInputs[] = {
    {"speed_slider_mask", RtdeType::uint32, [](Reader& in, int, W w) { w.slider_mask = in.u32(); }},
    {"speed_slider_fraction", RtdeType::double_, [](Reader& in, int, W w) { w.slider = finite(in.f64(), w.slider); }},
    {"standard_digital_output_mask", RtdeType::uint8, [](Reader& in, int, W w) { w.standard_mask = in.u8(); }},
    {"standard_digital_output", RtdeType::uint8, [](Reader& in, int, W w) { w.standard = in.u8(); }},
    {"configurable_digital_output_mask", RtdeType::uint8, [](Reader& in, int, W w) { w.configurable_mask = in.u8(); }},
    {"configurable_digital_output", RtdeType::uint8, [](Reader& in, int, W w) { w.configurable = in.u8(); }},
    {"tool_digital_output_mask", RtdeType::uint8, [](Reader& in, int, W w) { w.tool_mask = in.u8(); }},
    {"tool_digital_output", RtdeType::uint8, [](Reader& in, int, W w) { w.tool = in.u8(); }},
    {"standard_analog_output_mask", RtdeType::uint8, [](Reader& in, int, W w) { w.analog_mask = in.u8(); }},
    {"standard_analog_output_type", RtdeType::uint8, [](Reader& in, int, W w) { w.analog_type = in.u8(); }},
    {"external_force_torque", RtdeType::vector6d,
     [](Reader& in, int, W) { in.text(size_of(RtdeType::vector6d)); }},  // nothing feels it here
    {"standard_analog_output_0", RtdeType::double_,
     [](Reader& in, int, W w) { w.analog[0] = finite(in.f64(), w.analog[0]); }},
    {"standard_analog_output_1", RtdeType::double_,
     [](Reader& in, int, W w) { w.analog[1] = finite(in.f64(), w.analog[1]); }},
};

std::optional<RtdeInput> register_input(const RegisterName& name) {
  switch (name.kind) {
    case RegisterName::Kind::word:
      return RtdeInput{RtdeType::uint32, [](Reader& in, int i, W w) { w.registers.bits[std::size_t(i)] = in.u32(); },
                       name.index};
    case RegisterName::Kind::bit:
      return RtdeInput{RtdeType::bool_, [](Reader& in, int i, W w) { w.registers.set_bit(i, in.u8() != 0); },
                       name.index};
    case RegisterName::Kind::integer:
      return RtdeInput{
          RtdeType::int32,
          [](Reader& in, int i, W w) { w.registers.integers[std::size_t(i)] = static_cast<std::int32_t>(in.u32()); },
          name.index};
    case RegisterName::Kind::double_:
      return RtdeInput{RtdeType::double_,
                       [](Reader& in, int i, W w) { w.registers.doubles[std::size_t(i)] = finite(in.f64(), 0); },
                       name.index};
  }
  return std::nullopt;
}

void apply_outputs(std::uint8_t mask, std::uint8_t values, int first, Controller& controller) {
  for (int i = 0; i < 8; ++i) {
    if (((mask >> i) & 1) != 0) controller.set_output(first + i, ((values >> i) & 1) != 0);
  }
}

/** The number behind a prefix, within its bounds. */
std::optional<int> number_behind(std::string_view name, std::string_view prefix, int from, int to) {
  if (!name.starts_with(prefix)) return std::nullopt;
  const std::string_view digits = name.substr(prefix.size());
  const auto number = digits.size() <= 3 ? parse_integer(digits) : std::nullopt;
  if (!number || *number < from || *number >= to || std::to_string(*number) != digits) return std::nullopt;
  return static_cast<int>(*number);
}

}  // namespace

std::optional<RegisterName> register_name(std::string_view name, std::string_view prefix) {
  constexpr int kFirstSingleBit = 64;
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  using Kind = RegisterName::Kind;
  if (name == "bit_registers0_to_31") return RegisterName{Kind::word, 0};
  if (name == "bit_registers32_to_63") return RegisterName{Kind::word, 1};
  if (const auto bit = number_behind(name, "bit_register_", kFirstSingleBit, Registers::kBits)) {
    return RegisterName{Kind::bit, *bit};
  }
  if (const auto at = number_behind(name, "int_register_", 0, Registers::kNumbers)) {
    return RegisterName{Kind::integer, *at};
  }
  if (const auto at = number_behind(name, "double_register_", 0, Registers::kNumbers)) {
    return RegisterName{Kind::double_, *at};
  }
  return std::nullopt;
}

std::optional<RtdeInput> rtde_input(std::string_view name) {
  for (const InputRow& row : kInputs) {
    if (row.name == name) return RtdeInput{row.type, row.take, 0};
  }
  const auto numbered = register_name(name, "input_");
  return numbered ? register_input(*numbered) : std::nullopt;
}

void apply(const RtdeWritten& written, Controller& controller, double now) {
  constexpr int kConfigurable = 8, kTool = 16;
  if (written.slider_mask != 0) controller.set_speed_fraction(written.slider, now);
  apply_outputs(written.standard_mask, written.standard, 0, controller);
  apply_outputs(written.configurable_mask, written.configurable, kConfigurable, controller);
  apply_outputs(written.tool_mask & 3, written.tool, kTool, controller);
  for (std::size_t i = 0; i < written.analog.size(); ++i) {
    if (((written.analog_mask >> i) & 1) != 0) controller.set_analog_output(i, written.analog[i]);
  }
  controller.set_input_registers(written.registers);
}

}  // namespace trb::virtual_robots::ur
