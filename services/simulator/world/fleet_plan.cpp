#include "services/simulator/world/fleet_plan.hpp"

#include <algorithm>

namespace trb::world {
namespace {

Parameter parameter_of(const ParameterInfo& info) {
  constexpr auto kTypes = enum_names(ParameterType{});
  Parameter out;
  out.name = info.name;
  const auto* const type = std::ranges::find(kTypes, info.type);
  if (type != kTypes.end()) out.type = static_cast<ParameterType>(type - kTypes.begin());
  out.required = info.required;
  out.unit = info.unit;
  if (info.range.size() == 2) {
    out.minimum = info.range[0];
    out.maximum = info.range[1];
  }
  out.one_of = info.one_of;
  if (info.count > 0) out.count = info.count;
  return out;
}

}  // namespace

std::vector<PlannedRobot> paper_robots(std::uint32_t count, double timeout_s) {
  NodeProfile profile;
  profile.capabilities = {"hands"};
  profile.skills = {{.name = "work", .capability = "hands", .parameters = {}, .timeout_s = timeout_s}};
  std::vector<PlannedRobot> out;
  out.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) out.push_back({"r" + std::to_string(i), profile});
  return out;
}

Description description_of(const NodeProfile& profile) {
  Description out;
  out.capabilities = profile.capabilities;
  out.sensors = profile.sensors;
  for (const SkillInfo& info : profile.skills) {
    Skill skill;
    skill.name = skill.subtype = info.name;
    skill.capability = info.capability;
    for (const ParameterInfo& parameter : info.parameters) skill.parameters.push_back(parameter_of(parameter));
    skill.timeout_s = info.timeout_s;
    skill.repeatable = info.repeatable;
    out.skills.push_back(std::move(skill));
  }
  // Its own terms for a place, which nobody looks at here.
  for (const std::string& place : profile.places) out.places.emplace(place, Value{place});
  return out;
}

}  // namespace trb::world
