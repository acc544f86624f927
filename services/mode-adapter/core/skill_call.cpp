#include "services/mode-adapter/core/skill_call.hpp"

#include <cmath>

#include "common/drivers/text/number_text.hpp"
#include "services/mode-adapter/core/drivers.hpp"
#include "services/mode-adapter/core/skill_parameters.hpp"

namespace trb::adapter {
namespace {

/// Converts a pose in the hall to the robot's frame: its origin, direction and units.
Pose in_robot_frame(const Pose& hall, const RobotFrame& frame) {
  const double east = hall.x - frame.origin.x;
  const double north = hall.y - frame.origin.y;
  const double c = std::cos(-frame.origin.yaw);
  const double s = std::sin(-frame.origin.yaw);
  const double yaw = std::remainder(hall.yaw - frame.origin.yaw, 2 * M_PI);
  return {(c * east - s * north) * frame.length, (s * east + c * north) * frame.length,
          (hall.z - frame.origin.z) * frame.length, yaw * frame.angle};
}

Value scaled(const Value& value, double factor) {
  if (factor == 1) return value;
  if (value.is_number()) return Value{value.number() * factor};
  Value::List list;
  for (const Value& item : value.list()) list.push_back(scaled(item, factor));
  return Value{std::move(list)};
}

std::string write(const Value& value, CallStyle style) {
  if (value.is_number()) return value.is_integer() ? std::to_string(value.integer()) : number_text(value.number());
  if (value.is_bool() && style == CallStyle::numbers) return value.boolean() ? "1" : "0";
  if (value.is_text() && style != CallStyle::json) return value.text();
  if (!value.is_list()) return dump_json(value);
  std::string out;
  for (const Value& item : value.list()) {
    if (!out.empty()) out += style == CallStyle::json ? "," : " ";
    out += write(item, style);
  }
  return style == CallStyle::json ? "[" + out + "]" : out;
}

std::vector<double> numbers_of(const Value& value) {
  std::vector<double> numbers;
  if (value.is_number()) numbers.push_back(value.number());
  if (!value.is_list()) return numbers;
  for (const Value& item : value.list()) {
    if (item.is_number()) numbers.push_back(item.number());
  }
  return numbers;
}

/// Fills one skill's template for one robot.
class Filler {
 public:
  Filler(const Arguments& arguments, const Skill& skill, const Description& description, const Places& places)
      : arguments_(arguments), skill_(skill), description_(description), places_(places) {}

  [[nodiscard]] Result<std::string> fill(CallStyle style) const {
    std::string out;
    std::string_view text = skill_.data;
    while (!text.empty()) {
      const std::size_t open = text.find('{');
      out += text.substr(0, open);
      const std::size_t close = open == std::string_view::npos ? open : text.find('}', open);
      if (close == std::string_view::npos) break;
      auto value = placeholder(text.substr(open + 1, close - open - 1));
      if (!value) return value.error();
      out += write(*value, style);
      text.remove_prefix(close + 1);
    }
    return out;
  }

  /// Places are checked even if the data uses no coordinate of them: no robot must be sent to an unknown place.
  [[nodiscard]] Status check_places() const {
    for (const Parameter& parameter : skill_.parameters) {
      const auto argument = arguments_.find(parameter.name);
      if (parameter.type != ParameterType::place || argument == arguments_.end()) continue;
      const std::string& place = argument->second.text();
      if (!places_.contains(place) && !description_.places.contains(place)) return unknown_place(parameter.name, place);
    }
    return Done{};
  }

  [[nodiscard]] std::vector<double> target(const std::string& name) const {
    const auto argument = arguments_.find(name);
    if (argument == arguments_.end()) return {};
    if (type_of(name) != ParameterType::place) return numbers_of(converted(name, argument->second));
    const auto own = description_.places.find(argument->second.text());
    if (own != description_.places.end()) return numbers_of(own->second);
    const auto pose = places_.find(argument->second.text());
    if (pose == places_.end()) return {};
    const Pose here = in_robot_frame(pose->second, description_.frame);
    return {here.x, here.y};
  }

 private:
  static Error unknown_place(std::string_view parameter, const std::string& place) {
    return fail(Errc::unknown_place, "parameter '" + std::string(parameter) + "': there is no place '" + place + "'",
                "add it to places.json or to the robot's description");
  }

  [[nodiscard]] const Parameter* find(std::string_view name) const {
    for (const Parameter& parameter : skill_.parameters) {
      if (parameter.name == name) return &parameter;
    }
    return nullptr;
  }

  [[nodiscard]] ParameterType type_of(std::string_view name) const {
    const Parameter* parameter = find(name);
    return parameter == nullptr ? ParameterType::text : parameter->type;
  }

  [[nodiscard]] Value converted(std::string_view name, const Value& value) const {
    const Parameter* parameter = find(name);
    return parameter == nullptr ? value : scaled(value, description_.frame.factor_of(parameter->unit));
  }

  [[nodiscard]] Result<Value> placeholder(std::string_view inside) const {
    const std::size_t dot = inside.find('.');
    const std::string_view name = inside.substr(0, dot);
    const auto argument = arguments_.find(name);
    if (argument == arguments_.end()) {
      return fail(Errc::missing, "parameter '" + std::string(name) + "': is not given, and the command needs it");
    }
    if (type_of(name) != ParameterType::place) return converted(name, argument->second);
    const std::string& place = argument->second.text();
    if (dot != std::string_view::npos) return coordinate(name, place, inside.substr(dot + 1));
    const auto own = description_.places.find(place);
    return own == description_.places.end() ? argument->second : own->second;
  }

  [[nodiscard]] Result<Value> coordinate(std::string_view name, const std::string& place, std::string_view axis) const {
    const auto pose = places_.find(place);
    if (pose == places_.end()) return unknown_place(name, place);
    const Pose here = in_robot_frame(pose->second, description_.frame);
    if (axis == "x") return Value{here.x};
    if (axis == "y") return Value{here.y};
    if (axis == "z") return Value{here.z};
    const double half_turn = here.yaw / description_.frame.angle / 2;
    if (axis == "qz") return Value{std::sin(half_turn)};
    if (axis == "qw") return Value{std::cos(half_turn)};
    return Value{here.yaw};
  }

  const Arguments& arguments_;
  const Skill& skill_;
  const Description& description_;
  const Places& places_;
};

}  // namespace

Result<SkillCall> render_call(const Skill& skill, std::string_view parameters, const Description& description,
                              const Places& places, CallStyle style) {
  const auto arguments = read_arguments(skill, parameters);
  if (!arguments) return arguments.error();
  const Filler filler(*arguments, skill, description, places);
  if (Status known = filler.check_places(); !known) return known.error();
  auto data = filler.fill(style);
  if (!data) return data.error();
  SkillCall call{std::move(*data), {}};
  if (skill.end.kind == EndKind::position) call.target = filler.target(skill.end.target);
  return call;
}

}  // namespace trb::adapter
