#include "services/virtual-robots/ur/functions.hpp"

#include <algorithm>
#include <cmath>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

using Kind = Parameter::Kind;

double number_or(const Bound& bound, std::size_t index, double otherwise) {
  return bound[index] ? std::get<double>(*bound[index]) : otherwise;
}

std::string show_list(const double* numbers, std::size_t count) {
  std::string out = "[";
  for (std::size_t i = 0; i < count; ++i) out += (i == 0 ? "" : ", ") + format_fixed(numbers[i], 6);
  return out + "]";
}

std::variant<Joints, Pose> target_of(const Value& value) {
  if (const auto* pose = std::get_if<Pose>(&value)) return *pose;
  Joints joints{};
  std::copy_n(std::get<std::vector<double>>(value).begin(), kJointCount, joints.begin());
  return joints;
}

Step make_move(const std::string& function, const Bound& bound) {
  return MoveStep{function, target_of(*bound[0]), number_or(bound, 2, 0), number_or(bound, 3, 0), 1, 1};
}

/** stopj and stopl brake with this if no acceleration is given. */
constexpr double kStopAcceleration = 2;
constexpr double kSpeedAcceleration = 1.4;

Step make_speed(const std::string& function, const Bound& bound) {
  SpeedStep step{function, {}, number_or(bound, 1, kSpeedAcceleration), number_or(bound, 2, 0)};
  std::copy_n(std::get<std::vector<double>>(*bound[0]).begin(), kJointCount, step.speeds.begin());
  return step;
}

Step make_sleep(const std::string&, const Bound& bound) {
  return SleepStep{number_or(bound, 0, 0)};
}

Step make_sync(const std::string&, const Bound&) {
  return SleepStep{kStepTime};
}

Step make_digital_out(const std::string&, const Bound& bound) {
  const double index = std::clamp(number_or(bound, 0, 0), 0.0, 63.0);
  return DigitalOutStep{static_cast<int>(index), std::get<bool>(*bound[1])};
}

/** `first`: the bit of pin 0. */
template <int kFirst, int kPins>
Step make_pin(const std::string&, const Bound& bound) {
  const double pin = number_or(bound, 0, 0);
  if (!(pin >= 0 && pin < kPins)) throw ScriptFault{"runtime_error_no_pin:" + show(*bound[0]) + ":"};
  return DigitalOutStep{kFirst + static_cast<int>(pin), std::get<bool>(*bound[1])};
}

Step make_text(const std::string&, const Bound& bound) {
  return TextStep{show(*bound[0]) + (bound[1] ? show(*bound[1]) : "")};
}

Step make_popup(const std::string&, const Bound& bound) {
  return TextStep{show(*bound[0])};
}

Step make_halt(const std::string&, const Bound& bound) {
  return HaltStep{number_or(bound, 0, kStopAcceleration)};
}

Step make_tool(const std::string&, const Bound& bound) {
  return ToolStep{std::get<Pose>(*bound[0])};
}

Step make_setting(const std::string& function, const Bound&) {
  return SettingStep{function};
}

Step make_protective_stop(const std::string&, const Bound&) {
  return ProtectiveStopStep{};
}

Step register_step(RegisterStep::Kind kind, int count, const Bound& bound, double value) {
  const double index = number_or(bound, 0, 0);
  if (!(index >= 0 && index < count)) throw ScriptFault{"runtime_error_no_register:" + show(*bound[0]) + ":"};
  return RegisterStep{kind, static_cast<int>(index), value};
}

Step make_integer(const std::string&, const Bound& bound) {
  const double value = std::clamp(number_or(bound, 1, 0), -2147483648.0, 2147483647.0);
  return register_step(RegisterStep::Kind::integer, Registers::kNumbers, bound, value);
}

Step make_float(const std::string&, const Bound& bound) {
  return register_step(RegisterStep::Kind::float_, Registers::kNumbers, bound, number_or(bound, 1, 0));
}

Step make_boolean(const std::string&, const Bound& bound) {
  return register_step(RegisterStep::Kind::boolean, Registers::kBits, bound, std::get<bool>(*bound[1]) ? 1 : 0);
}

Function doing(std::string_view name, std::vector<Parameter> parameters, Step (*make)(const std::string&, const Bound&),
               bool takes_time = false) {
  return {name, std::move(parameters), make, nullptr, Shape::Kind::none, takes_time};
}

}  // namespace

const std::vector<Function>& doing_functions() {
  static const std::vector<Parameter> kMove = {
      {"q", Kind::target, true}, {"a", Kind::number}, {"v", Kind::number}, {"t", Kind::number}, {"r", Kind::number}};
  static const std::vector<Parameter> kLine = {
      {"pose", Kind::target, true}, {"a", Kind::number}, {"v", Kind::number}, {"t", Kind::number}, {"r", Kind::number}};
  static const std::vector<Parameter> kOut = {{"n", Kind::number, true}, {"b", Kind::boolean, true}};
  static const std::vector<Parameter> kPopup = {{"s", Kind::any, true},
                                                {"title", Kind::text},
                                                {"warning", Kind::boolean},
                                                {"error", Kind::boolean},
                                                {"blocking", Kind::boolean}};
  static const std::vector<Parameter> kRegister = {{"n", Kind::number, true}, {"value", Kind::number, true}};
  static const std::vector<Function> kFunctions = {
      doing("movej", kMove, make_move, true),
      doing("movel", kLine, make_move, true),
      doing("sleep", {{"t", Kind::number, true}}, make_sleep, true),
      doing("sync", {}, make_sync, true),
      doing("set_digital_out", kOut, make_digital_out),
      doing("set_standard_digital_out", kOut, make_digital_out),
      doing("set_configurable_digital_out", kOut, make_pin<8, 8>),
      doing("set_tool_digital_out", kOut, make_pin<16, 2>),
      doing("textmsg", {{"s1", Kind::any, true}, {"s2", Kind::any}}, make_text),
      doing("popup", kPopup, make_popup),
      doing("set_tcp", {{"pose", Kind::pose, true}, {"tcp_name", Kind::text}}, make_tool),
      doing("set_payload", {{"m", Kind::number, true}, {"cog", Kind::any}}, make_setting),
      doing("set_payload_mass", {{"m", Kind::number, true}}, make_setting),
      doing("set_target_payload", {{"m", Kind::number, true}, {"cog", Kind::any}, {"inertia", Kind::any}},
            make_setting),
      doing("set_gravity", {{"d", Kind::list, true}}, make_setting),
      doing("set_tool_voltage", {{"voltage", Kind::number, true}}, make_setting),
      doing("speedj", {{"qd", Kind::six, true}, {"a", Kind::positive}, {"t", Kind::number}}, make_speed, true),
      doing("speedl", {{"xd", Kind::six, true}, {"a", Kind::positive}, {"t", Kind::number}, {"aRot", Kind::text}},
            make_speed, true),
      doing("stopj", {{"a", Kind::positive}}, make_halt),
      doing("stopl", {{"a", Kind::positive}}, make_halt),
      doing("protective_stop", {}, make_protective_stop),
      doing("write_output_integer_register", kRegister, make_integer),
      doing("write_output_float_register", kRegister, make_float),
      doing("write_output_boolean_register", {{"n", Kind::number, true}, {"value", Kind::boolean, true}}, make_boolean),
  };
  return kFunctions;
}

const Function* function_of(std::string_view name) {
  for (const auto* functions : {&doing_functions(), &telling_functions(), &reckoning_functions()}) {
    const auto found = std::find_if(functions->begin(), functions->end(),
                                    [&](const Function& function) { return function.name == name; });
    if (found != functions->end()) return &*found;
  }
  return nullptr;
}

std::string show(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return format_fixed(*number, 6);
  if (const auto* boolean = std::get_if<bool>(&value)) return *boolean ? "True" : "False";
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* list = std::get_if<std::vector<double>>(&value)) return show_list(list->data(), list->size());
  if (const auto* pose = std::get_if<Pose>(&value)) return "p" + show_list(pose->values.data(), pose->values.size());
  return "None";
}

Shape shape_of(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return {Shape::Kind::number, {}, *number};
  if (std::holds_alternative<bool>(value)) return {Shape::Kind::boolean, {}, {}};
  if (std::holds_alternative<std::string>(value)) return {Shape::Kind::text, {}, {}};
  if (const auto* list = std::get_if<std::vector<double>>(&value)) return {Shape::Kind::list, list->size(), {}};
  return {std::holds_alternative<Pose>(value) ? Shape::Kind::pose : Shape::Kind::none, {}, {}};
}

bool fits(Kind kind, const Shape& shape) {
  if (shape.kind == Shape::Kind::any) return true;
  switch (kind) {
    case Kind::number:
      return shape.kind == Shape::Kind::number;
    case Kind::positive:
      return shape.kind == Shape::Kind::number && (!shape.number || *shape.number > 0);
    case Kind::six:
    case Kind::list:
      return shape.kind == Shape::Kind::list;
    case Kind::boolean:
      return shape.kind == Shape::Kind::boolean;
    case Kind::text:
      return shape.kind == Shape::Kind::text;
    case Kind::target:
      return shape.kind == Shape::Kind::list || shape.kind == Shape::Kind::pose;
    case Kind::pose:
      return shape.kind == Shape::Kind::pose;
    case Kind::any:
      return shape.kind != Shape::Kind::none;
  }
  return false;
}

bool counts(Kind kind, const Shape& shape) {
  const bool six = kind == Kind::target || kind == Kind::six;
  return !six || shape.kind != Shape::Kind::list || !shape.count || *shape.count == kJointCount;
}

}  // namespace trb::virtual_robots::ur
