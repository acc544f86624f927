#include "services/virtual-robots/ur/functions.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::ur {
namespace {

enum class Kind { Number, Positive, Boolean, Text, Target, Six, Pose, Any };

struct Parameter {
  std::string_view name;
  Kind kind;
  bool required = false;
};

using Bound = std::vector<std::optional<Value>>;

struct Function {
  std::string_view name;
  std::vector<Parameter> parameters;
  Step (*make)(const std::string& function, const Bound& bound);
};

double number_or(const Bound& bound, std::size_t index, double otherwise) {
  return bound[index] ? std::get<double>(*bound[index]) : otherwise;
}

std::string show_list(const double* numbers, std::size_t count) {
  std::string out = "[";
  for (std::size_t i = 0; i < count; ++i) out += (i == 0 ? "" : ", ") + format_fixed(numbers[i], 6);
  return out + "]";
}

std::string show(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return format_fixed(*number, 6);
  if (const auto* boolean = std::get_if<bool>(&value)) return *boolean ? "True" : "False";
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* list = std::get_if<std::vector<double>>(&value)) return show_list(list->data(), list->size());
  return "p" + show_list(std::get<Pose>(value).values.data(), 6);
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

Step make_digital_out(const std::string&, const Bound& bound) {
  const double index = std::clamp(number_or(bound, 0, 0), 0.0, 63.0);
  return DigitalOutStep{static_cast<int>(index), std::get<bool>(*bound[1])};
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

const std::vector<Function>& functions() {
  static const std::vector<Parameter> kMove = {
      {"q", Kind::Target, true}, {"a", Kind::Number}, {"v", Kind::Number}, {"t", Kind::Number}, {"r", Kind::Number}};
  static const std::vector<Parameter> kLine = {
      {"pose", Kind::Target, true}, {"a", Kind::Number}, {"v", Kind::Number}, {"t", Kind::Number}, {"r", Kind::Number}};
  static const std::vector<Parameter> kOut = {{"n", Kind::Number, true}, {"b", Kind::Boolean, true}};
  static const std::vector<Function> kFunctions = {
      {"movej", kMove, make_move},
      {"movel", kLine, make_move},
      {"sleep", {{"t", Kind::Number, true}}, make_sleep},
      {"set_digital_out", kOut, make_digital_out},
      {"set_standard_digital_out", kOut, make_digital_out},
      {"textmsg", {{"s1", Kind::Any, true}, {"s2", Kind::Any}}, make_text},
      {"popup",
       {{"s", Kind::Any, true},
        {"title", Kind::Text},
        {"warning", Kind::Boolean},
        {"error", Kind::Boolean},
        {"blocking", Kind::Boolean}},
       make_popup},
      {"set_tcp", {{"pose", Kind::Pose, true}, {"tcp_name", Kind::Text}}, make_tool},
      {"set_payload", {{"m", Kind::Number, true}, {"cog", Kind::Any}}, make_setting},
      {"speedj", {{"qd", Kind::Six, true}, {"a", Kind::Positive}, {"t", Kind::Number}}, make_speed},
      {"speedl",
       {{"xd", Kind::Six, true}, {"a", Kind::Positive}, {"t", Kind::Number}, {"aRot", Kind::Text}},
       make_speed},
      {"stopj", {{"a", Kind::Positive}}, make_halt},
      {"stopl", {{"a", Kind::Positive}}, make_halt},
  };
  return kFunctions;
}

bool fits(Kind kind, const Value& value) {
  switch (kind) {
    case Kind::Number:
      return std::holds_alternative<double>(value);
    case Kind::Positive: {
      const auto* number = std::get_if<double>(&value);
      return number != nullptr && *number > 0;
    }
    case Kind::Six:
      return std::holds_alternative<std::vector<double>>(value);
    case Kind::Boolean:
      return std::holds_alternative<bool>(value);
    case Kind::Text:
      return std::holds_alternative<std::string>(value);
    case Kind::Target:
      return std::holds_alternative<std::vector<double>>(value) || std::holds_alternative<Pose>(value);
    case Kind::Pose:
      return std::holds_alternative<Pose>(value);
    case Kind::Any:
      return true;
  }
  return false;
}

/** Binds the arguments of one call to the parameters of its function. */
class Binder {
 public:
  Binder(const ScriptLine& line, const Call& call, const Function& function)
      : line_(line), call_(call), parameters_(function.parameters), bound_(function.parameters.size()) {}

  Bound bind() {
    for (std::size_t i = 0; i < call_.arguments.size(); ++i) bind_argument(call_.arguments[i], i);
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (parameters_[i].required && !bound_[i]) fail("missing_argument", parameters_[i].name, call_.column);
    }
    return bound_;
  }

 private:
  void bind_argument(const Argument& argument, std::size_t place) {
    const std::size_t index = argument.key.empty() ? place : index_of(argument);
    if (index >= parameters_.size()) fail("too_many_arguments", "", argument.column);
    const Parameter& parameter = parameters_[index];
    if (!fits(parameter.kind, argument.value)) fail("wrong_type", parameter.name, argument.column);
    const auto* list = std::get_if<std::vector<double>>(&argument.value);
    const bool six = parameter.kind == Kind::Target || parameter.kind == Kind::Six;
    const bool miscounted = six && list != nullptr && list->size() != kJointCount;
    if (miscounted) fail("wrong_joint_count", "", argument.column);
    bound_[index] = argument.value;
  }

  std::size_t index_of(const Argument& argument) const {
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (parameters_[i].name == argument.key) return i;
    }
    fail("unknown_argument", argument.key, argument.column);
  }

  [[noreturn]] void fail(std::string_view what, std::string_view which, int column) const {
    std::string text = "compile_error_" + std::string(what) + ":" + call_.function + ":";
    if (!which.empty()) text += std::string(which) + ":";
    fail_with(line_, column, text);
  }

  const ScriptLine& line_;
  const Call& call_;
  const std::vector<Parameter>& parameters_;
  Bound bound_;
};

}  // namespace

Step bind_call(const ScriptLine& line, const Call& call) {
  for (const Function& function : functions()) {
    if (function.name != call.function) continue;
    Step step = function.make(call.function, Binder(line, call, function).bind());
    if (auto* move = std::get_if<MoveStep>(&step)) {
      move->line = line.number;
      move->column = call.column;
    }
    return step;
  }
  fail_with(line, call.column, "compile_error_name_not_found:" + call.function + ":");
}

}  // namespace trb::virtual_robots::ur
