#include "services/resilience/core/robot_record.hpp"

#include <algorithm>

#include "common/base/words.hpp"
#include "common/scenario/task_need.hpp"
#include "services/resilience/core/robot_state.hpp"

namespace trb::resilience {
namespace {

bool works(const SensorInfo& sensor) {
  return sensor.state == SensorState::ok || sensor.state == SensorState::unread;
}

/// The router adds a plugged sensor's kind to the capabilities: is there one of that kind, but none that works?
bool sensors_fail(const std::vector<SensorInfo>& plugged, std::string_view kind) {
  const auto is_kind = [&](const SensorInfo& sensor) { return sensor.kind == kind; };
  return std::ranges::any_of(plugged, is_kind) &&
         std::ranges::none_of(plugged, [&](const SensorInfo& sensor) { return is_kind(sensor) && works(sensor); });
}

}  // namespace

bool takes_away(const Fault& fault) {
  return fault.severity >= Severity::critical;
}

bool is_standing(const OutOfUse& one) {
  return !one.retired && one.severity >= Severity::critical;
}

const Fault* fault_of(const RobotRecord& robot, std::string_view capability) {
  const Fault* worst = nullptr;
  for (const Fault& fault : robot.faults) {
    if (!takes_away(fault) || (!fault.capability.empty() && fault.capability != capability)) continue;
    if (worst == nullptr || fault.severity > worst->severity) worst = &fault;
  }
  return worst;
}

const Fault* worst_fault(const RobotRecord& robot, std::string_view capability) {
  const Fault* worst = nullptr;
  for (const Fault& fault : robot.faults) {
    if (!takes_away(fault) || fault.capability != capability) continue;
    if (worst == nullptr || fault.severity > worst->severity) worst = &fault;
  }
  return worst;
}

const OutOfUse* retirement_of(const RobotRecord& robot) {
  const auto at = std::ranges::find_if(robot.profile.is.out_of_use, &OutOfUse::retired);
  return at == robot.profile.is.out_of_use.end() ? nullptr : &*at;
}

std::string retired_text(const OutOfUse& retirement) {
  return "is out of service" + (retirement.text.empty() ? "" : ": " + retirement.text) +
         (retirement.by.empty() ? "" : " (by " + retirement.by + ")");
}

bool is_reported_broken(const RobotRecord& robot, std::string_view capability) {
  return std::ranges::any_of(robot.profile.is.out_of_use,
                             [&](const OutOfUse& one) { return is_standing(one) && one.capability == capability; });
}

bool is_able(const RobotRecord& robot, std::string_view capability) {
  const NodeProfile& profile = robot.profile.is;
  return contains(profile.capabilities, capability) && fault_of(robot, capability) == nullptr &&
         !sensors_fail(profile.plugged, capability);
}

bool is_fit(const RobotRecord& robot) {
  const NodeProfile& profile = robot.profile.is;
  return robot.reached && profile.robot == "ONLINE" && !profile.fenced && retirement_of(robot) == nullptr &&
         fault_of(robot, "") == nullptr;
}

std::string why_unfit(const RobotRecord& robot) {
  const NodeProfile& profile = robot.profile.is;
  if (!robot.reached) return "its node is not reached";
  if (profile.robot.empty()) return "its node has no robot";
  if (profile.robot != "ONLINE") return "is " + profile.robot + (profile.detail.empty() ? "" : ": " + profile.detail);
  if (profile.fenced) return "is stopped until it is released";
  if (const OutOfUse* retirement = retirement_of(robot)) return retired_text(*retirement);
  if (const Fault* fault = fault_of(robot, "")) return std::string(name_of(fault->severity)) + " fault: " + fault->text;
  return {};
}

const SkillInfo* find_skill(const RobotRecord& robot, std::string_view skill) {
  return trb::find_skill(robot.profile.is, skill);
}

double availability(const RobotRecord& robot) {
  return 100.0 / (1.0 + robot.later_tasks);
}

std::string capability_word(std::string_view capability) {
  return "capability " + std::string(capability);
}

std::string skill_word(std::string_view skill) {
  return "skill " + std::string(skill);
}

std::vector<std::string> words_of(const RobotRecord& robot) {
  std::vector<std::string> words;
  for (const std::string& capability : robot.profile.is.capabilities) {
    if (is_able(robot, capability)) words.push_back(capability_word(capability));
  }
  for (const SkillInfo& skill : robot.profile.is.skills) {
    if (skill.capability.empty() || is_able(robot, skill.capability)) words.push_back(skill_word(skill.name));
  }
  if (is_fit(robot)) words.emplace_back(kFitWord);
  return words;
}

Measures measures_of(const RobotRecord& robot) {
  Measures out;
  if (const auto charge = charge_of(robot)) out.charge = charge->is;
  if (const auto position = position_of(robot)) {
    out.x = position->is.x;
    out.y = position->is.y;
  }
  out.availability = availability(robot);
  return out;
}

}  // namespace trb::resilience
