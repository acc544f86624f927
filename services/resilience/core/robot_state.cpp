#include "services/resilience/core/robot_state.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "proto/value.hpp"

namespace trb::resilience {
namespace {

constexpr double kFarthest = 1e6;  ///< m; anything beyond is no position in a hall

/// JSON, or the plain words of a robot with fields.
Value value_of(const std::string& told) {
  auto json = parse_json(told);
  return json ? std::move(*json) : Value{told};
}

/// "1.5 0 0.375": numbers with blanks or commas between them.
std::vector<double> numbers_in(std::string_view words) {
  std::vector<double> out;
  const char* at = words.data();
  const char* const end = at + words.size();
  while (true) {
    at = std::find_if(at, end, [](char c) { return c != ' ' && c != ','; });
    if (at == end) return out;
    double number = 0;
    const auto read = std::from_chars(at, end, number);
    if (read.ec != std::errc()) return {};
    out.push_back(number);
    at = read.ptr;
  }
}

std::vector<double> numbers_of(const Value& value) {
  if (value.is_number()) return {value.number()};
  if (value.is_text()) return numbers_in(value.text());
  std::vector<double> out;
  if (value.is_list()) {
    for (const Value& item : value.list()) {
      if (!item.is_number()) return {};
      out.push_back(item.number());
    }
  } else if (value.is_object()) {
    for (const char* key : {"x", "y"}) {
      const Value* number = value.find(key);
      if (number == nullptr || !number->is_number()) return {};
      out.push_back(number->number());
    }
  }
  return out;
}

std::optional<double> within(const Reported<std::string>& told, double highest) {
  const Value value = value_of(told.is);
  if (value.is_list() || value.is_object()) return std::nullopt;
  const auto numbers = numbers_of(value);
  // Written so that NaN counts as out of range.
  if (numbers.size() != 1 || !(numbers[0] >= 0 && numbers[0] <= highest)) return std::nullopt;
  return numbers[0] / highest * 100;
}

bool is_in_hall(double x, double y) {
  return std::abs(x) <= kFarthest && std::abs(y) <= kFarthest;
}

}  // namespace

std::optional<Reported<double>> charge_of(const RobotRecord& robot) {
  if (const auto at = robot.values.find("state_of_charge"); at != robot.values.end()) {
    if (const auto percent = within(at->second, 100)) return Reported<double>{*percent, at->second.at};
  }
  const auto at = robot.values.find("battery");
  const auto full = full_battery(robot.profile.is);
  if (at == robot.values.end() || !full) return std::nullopt;
  const auto percent = within(at->second, *full);
  return percent ? std::optional(Reported<double>{*percent, at->second.at}) : std::nullopt;
}

std::optional<Reported<HallPoint>> position_of(const RobotRecord& robot) {
  const NodeProfile& profile = robot.profile.is;
  const FrameInfo& frame = profile.frame;
  if (!(frame.length > 0) || !is_in_hall(frame.x, frame.y) || !std::isfinite(frame.yaw)) return std::nullopt;
  if (!moves(profile)) {
    if (frame == FrameInfo{frame.length, 0, 0, 0}) return std::nullopt;  // its place is not described
    return Reported<HallPoint>{{frame.x, frame.y}, robot.profile.at};
  }
  const auto at = robot.values.find(kPositionRequest);
  if (at == robot.values.end()) return std::nullopt;
  const auto numbers = numbers_of(value_of(at->second.is));
  if (numbers.size() < 2) return std::nullopt;
  const double east = numbers[0] / frame.length;
  const double north = numbers[1] / frame.length;
  const double c = std::cos(frame.yaw);
  const double s = std::sin(frame.yaw);
  const HallPoint point{frame.x + c * east - s * north, frame.y + s * east + c * north};
  return is_in_hall(point.x, point.y) ? std::optional(Reported<HallPoint>{point, at->second.at}) : std::nullopt;
}

std::optional<Reported<double>> number_of(const RobotRecord& robot, std::string_view name) {
  const auto at = robot.values.find(name);
  if (at == robot.values.end()) return std::nullopt;
  const Value told = value_of(at->second.is);
  const Value* member = told.find(name);
  const Value& value = member == nullptr ? told : *member;
  if (value.is_list() || value.is_object()) return std::nullopt;
  const auto numbers = numbers_of(value);
  if (numbers.size() != 1 || !std::isfinite(numbers[0])) return std::nullopt;
  return Reported<double>{numbers[0], at->second.at};
}

std::optional<Reported<std::string>> mode_of(const RobotRecord& robot) {
  for (const char* name : {"operating_mode", "robot_mode", "mode", "state"}) {
    const auto at = robot.values.find(name);
    if (at == robot.values.end()) continue;
    const Value value = value_of(at->second.is);
    return Reported<std::string>{value.is_text() ? value.text() : at->second.is, at->second.at};
  }
  return std::nullopt;
}

}  // namespace trb::resilience
