// What a script reckons, by itself.
#include <cmath>
#include <numbers>

#include "services/virtual-robots/ur/functions.hpp"
#include "services/virtual-robots/ur/geometry.hpp"

namespace trb::virtual_robots::ur {
namespace {

using Takes = Parameter::Kind;

double first(const Bound& bound) {
  return std::get<double>(*bound[0]);
}
double second(const Bound& bound) {
  return std::get<double>(*bound[1]);
}
const Pose& pose_at(const Bound& bound, std::size_t index) {
  return std::get<Pose>(*bound[index]);
}

/** A number that is none ends the program: nothing else would notice it. */
Value real(double number) {
  if (!std::isfinite(number)) throw ScriptFault{"runtime_error_not_a_number:"};
  return number;
}

template <double (*kReckon)(double)>
Value by(const World&, const Bound& bound) {
  return real(kReckon(first(bound)));
}

double to_radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}
double to_degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

Value arc_tangent(const World&, const Bound& bound) {
  return real(std::atan2(first(bound), second(bound)));
}

Value power(const World&, const Bound& bound) {
  return real(std::pow(first(bound), second(bound)));
}

Value norm(const World&, const Bound& bound) {
  if (const auto* number = std::get_if<double>(&*bound[0])) return std::abs(*number);
  const auto* list = std::get_if<std::vector<double>>(&*bound[0]);
  if (list == nullptr) throw ScriptFault{"runtime_error_wrong_type:norm:a:"};
  double square = 0;
  for (const double value : *list) square += value * value;
  return real(std::sqrt(square));
}

Value length(const World&, const Bound& bound) {
  return static_cast<double>(std::get<std::vector<double>>(*bound[0]).size());
}

Value text(const World&, const Bound& bound) {
  return show(*bound[0]);
}

Value joined_text(const World&, const Bound& bound) {
  constexpr std::size_t kLongest = 1023;
  std::string out = show(*bound[0]) + show(*bound[1]);
  if (out.size() > kLongest) throw ScriptFault{"runtime_error_text_too_long:str_cat:"};
  return out;
}

Value pose_trans(const World&, const Bound& bound) {
  return pose_of(compose(frame_of(pose_at(bound, 0)), frame_of(pose_at(bound, 1))));
}

Value pose_inv(const World&, const Bound& bound) {
  return pose_of(inverse(frame_of(pose_at(bound, 0))));
}

Value interpolated(const World&, const Bound& bound) {
  return pose_between(pose_at(bound, 0), pose_at(bound, 1), std::get<double>(*bound[2]));
}

Value point_distance(const World&, const Bound& bound) {
  return way_between(pose_at(bound, 0), pose_at(bound, 1));
}

Function reckoning(std::string_view name, std::vector<Parameter> parameters, Value (*tell)(const World&, const Bound&),
                   Shape::Kind gives = Shape::Kind::number) {
  return {name, std::move(parameters), nullptr, tell, gives, false};
}

}  // namespace

const std::vector<Function>& reckoning_functions() {
  using Gives = Shape::Kind;
  static const std::vector<Parameter> kOne = {{"f", Takes::number, true}};
  static const std::vector<Parameter> kTwo = {{"x", Takes::number, true}, {"y", Takes::number, true}};
  static const std::vector<Parameter> kPoses = {{"p_from", Takes::pose, true}, {"p_to", Takes::pose, true}};
  static const std::vector<Function> kFunctions = {
      reckoning("sqrt", kOne, by<std::sqrt>),
      reckoning("sin", kOne, by<std::sin>),
      reckoning("cos", kOne, by<std::cos>),
      reckoning("tan", kOne, by<std::tan>),
      reckoning("asin", kOne, by<std::asin>),
      reckoning("acos", kOne, by<std::acos>),
      reckoning("atan", kOne, by<std::atan>),
      reckoning("floor", kOne, by<std::floor>),
      reckoning("ceil", kOne, by<std::ceil>),
      reckoning("d2r", kOne, by<to_radians>),
      reckoning("r2d", kOne, by<to_degrees>),
      reckoning("atan2", kTwo, arc_tangent),
      reckoning("pow", kTwo, power),
      reckoning("norm", {{"a", Takes::any, true}}, norm),
      reckoning("length", {{"v", Takes::list, true}}, length),
      reckoning("get_list_length", {{"v", Takes::list, true}}, length),
      reckoning("to_str", {{"val", Takes::any, true}}, text, Gives::text),
      reckoning("str_cat", {{"op1", Takes::any, true}, {"op2", Takes::any, true}}, joined_text, Gives::text),
      reckoning("pose_trans", kPoses, pose_trans, Gives::pose),
      reckoning("pose_inv", {{"p_from", Takes::pose, true}}, pose_inv, Gives::pose),
      reckoning("interpolate_pose",
                {{"p_from", Takes::pose, true}, {"p_to", Takes::pose, true}, {"alpha", Takes::number, true}},
                interpolated, Gives::pose),
      reckoning("point_dist", kPoses, point_distance),
  };
  return kFunctions;
}

}  // namespace trb::virtual_robots::ur
