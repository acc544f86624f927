#include "services/resilience/core/criteria.hpp"

#include <algorithm>
#include <cmath>

#include "common/ranking/pairwise.hpp"
#include "services/resilience/core/robot_state.hpp"

namespace trb::resilience {
namespace {

constexpr std::string_view kSensor = "sensor:";

Measured reported(const std::optional<Reported<double>>& number) {
  return number ? Measured{number->is, number->at} : Measured{};
}

Measured distance_of(const RobotRecord& robot, const HallPoint& place) {
  const auto at = position_of(robot);
  if (!at) return {};
  const double way = std::hypot(at->is.x - place.x, at->is.y - place.y);
  return {way, at->at == robot.profile.at ? std::nullopt : std::optional(at->at)};
}

bool needs_one_of(const std::vector<std::string>& capabilities, const TaskNeed& need, const RobotRecord& robot) {
  const auto wanted = [&](const std::string& word) {
    return std::ranges::find(capabilities, word) != capabilities.end();
  };
  const SkillInfo* skill = find_skill(robot, need.skill);
  return (skill != nullptr && wanted(skill->capability)) || std::ranges::any_of(need.capabilities, wanted);
}

std::string with_unit(const ReplacementCriterion& criterion, double value) {
  return short_number(value) + (criterion.unit.empty() ? "" : " " + criterion.unit);
}

}  // namespace

Measured measure(const ReplacementCriterion& criterion, const RobotRecord& robot,
                 const std::optional<HallPoint>& place) {
  switch (criterion.from) {
    case CriterionSource::charge:
      return reported(charge_of(robot));
    case CriterionSource::distance:
      return place ? distance_of(robot, *place) : Measured{};
    case CriterionSource::availability:
      return {availability(robot), std::nullopt};
    case CriterionSource::robot:
      return reported(number_of(robot, criterion.value));
    case CriterionSource::sensor:
      return reported(number_of(robot, sensor_value(criterion.value)));
    case CriterionSource::description:
      break;
  }
  const auto& numbers = robot.profile.is.numbers;
  const auto at = std::ranges::find(numbers, criterion.value, &NamedNumber::name);
  return at == numbers.end() ? Measured{} : Measured{at->value, std::nullopt};
}

bool counts(const ReplacementCriterion& criterion, const std::vector<TaskNeed>& needs, const RobotRecord& robot,
            const std::optional<HallPoint>& place) {
  if (criterion.from == CriterionSource::distance && !place) return false;
  if (criterion.capabilities.empty()) return true;
  return std::ranges::any_of(needs,
                             [&](const TaskNeed& need) { return needs_one_of(criterion.capabilities, need, robot); });
}

std::string why_out(const ReplacementCriterion& criterion, double value) {
  if (!criterion.at_least && !criterion.at_most) return {};
  if (std::isnan(value)) return "its " + criterion.name + " is not known";
  const std::string is = criterion.name + " " + with_unit(criterion, value) + ", ";
  if (criterion.at_least && value < *criterion.at_least) {
    return is + "at least " + short_number(*criterion.at_least) + " wanted";
  }
  if (criterion.at_most && value > *criterion.at_most) {
    return is + "at most " + short_number(*criterion.at_most) + " wanted";
  }
  return {};
}

std::string why_out(const Criteria& criteria, const std::vector<TaskNeed>& needs, const RobotRecord& robot,
                    const std::optional<HallPoint>& place) {
  for (const ReplacementCriterion& one : criteria) {
    if ((!one.at_least && !one.at_most) || !counts(one, needs, robot, place)) continue;
    if (std::string why = why_out(one, measure(one, robot, place).value); !why.empty()) return why;
  }
  return {};
}

bool has_bounds(const Criteria& criteria) {
  return std::ranges::any_of(criteria, [](const auto& one) { return one.at_least || one.at_most; });
}

double worth(const ReplacementCriterion& criterion, double value) {
  if (std::isnan(value)) return 0;
  return std::clamp((value - criterion.worst) / (criterion.best - criterion.worst), 0.0, 1.0);
}

namespace {

constexpr double kMaxWeight = 1e9;

Status set_weight(Criteria& criteria, const WeighedCriterion& given) {
  const auto at = std::ranges::find(criteria, given.criterion, &ReplacementCriterion::name);
  if (at == criteria.end()) {
    std::string all;
    for (const ReplacementCriterion& one : criteria) all += (all.empty() ? "" : ", ") + one.name;
    return fail(Errc::bad_value, "weights: there is no criterion '" + given.criterion + "'", "use: " + all);
  }
  if (std::isfinite(given.weight) && given.weight >= 0 && given.weight <= kMaxWeight) {
    at->weight = given.weight;
    return Done{};
  }
  return fail(Errc::bad_value, "weights." + given.criterion + ": is no weight", "use a number from 0 to 1e9");
}

}  // namespace

Result<Criteria> weighed(Criteria criteria, const std::vector<WeighedCriterion>& weights) {
  if (weights.empty()) return criteria;
  for (ReplacementCriterion& one : criteria) one.weight = 0;
  for (const WeighedCriterion& one : weights) {
    if (Status set = set_weight(criteria, one); !set) return set.error();
  }
  double sum = 0;
  for (const ReplacementCriterion& one : criteria) sum += one.weight;
  if (!(sum > 0)) return fail(Errc::bad_value, "weights: all count nothing", "give one of them a weight over 0");
  for (ReplacementCriterion& one : criteria) one.weight /= sum;
  return criteria;
}

std::string sensor_value(std::string_view sensor) {
  return std::string(kSensor) + std::string(sensor);
}

bool is_sensor_of(const ReplacementCriterion& criterion, const RobotRecord& robot, std::string_view sensor) {
  if (criterion.from != CriterionSource::sensor) return false;
  if (criterion.value == sensor) return true;
  const auto& plugged = robot.profile.is.plugged;
  // As the node's sensor-bus finds it: a name comes before a kind.
  if (std::ranges::find(plugged, criterion.value, &SensorInfo::name) != plugged.end()) return false;
  const auto at = std::ranges::find(plugged, sensor, &SensorInfo::name);
  return at != plugged.end() && at->kind == criterion.value;
}

std::vector<Question> questions(const Criteria& criteria, const RobotRecord& robot, UtcTime now, Duration fresh) {
  std::vector<Question> out;
  // What seems to come was told before the clock was set back: nobody knows when.
  const auto is_old = [&](const auto& told) { return !told || told->at > now || told->at + fresh < now; };
  const std::string charge(charge_request(robot.profile.is));
  if (is_old(charge_of(robot))) out.push_back({charge, charge, ""});
  const std::string position(kPositionRequest);
  if (is_old(position_of(robot))) out.push_back({position, position, ""});
  for (const ReplacementCriterion& one : criteria) {
    if (one.from == CriterionSource::robot && is_old(number_of(robot, one.value))) {
      out.push_back({one.value, one.value, ""});
    }
    const std::string kept = sensor_value(one.value);
    if (one.from == CriterionSource::sensor && is_old(number_of(robot, kept))) out.push_back({kept, "", one.value});
  }
  return out;
}

}  // namespace trb::resilience
