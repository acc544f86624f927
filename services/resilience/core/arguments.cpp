#include "services/resilience/core/arguments.hpp"

#include <algorithm>

#include "common/scenario/parameters.hpp"

namespace trb::resilience {
namespace {

constexpr std::size_t kMaxWord = 40;

const Value* given(const TaskNeed& need, const std::string& name) {
  const auto at = std::ranges::find(need.arguments, name, [](const auto& argument) { return argument.first; });
  return at == need.arguments.end() ? nullptr : &at->second;
}

std::string of_parameter(const std::string& name, const std::string& what) {
  return "parameter '" + cut_utf8(name, kMaxWord) + "': " + what;
}

}  // namespace

std::string misfit(const SkillInfo& skill, const TaskNeed& need, const RobotRecord& robot) {
  const auto has = [&](const std::string& name) {
    return std::ranges::find(skill.parameters, name, &ParameterInfo::name) != skill.parameters.end();
  };
  for (const auto& [name, ignored] : need.arguments) {
    if (!has(name)) return of_parameter(name, "its skill has none of that name");
  }
  for (const std::string& name : need.later) {
    if (!has(name)) return of_parameter(name, "its skill has none of that name");
  }
  for (const ParameterInfo& info : skill.parameters) {
    const Value* value = given(need, info.name);
    if (value == nullptr) {
      const bool is_later = std::ranges::find(need.later, info.name) != need.later.end();
      if (info.required && !is_later) return of_parameter(info.name, "it is required here");
      continue;
    }
    const Misfit wrong = misfit_of(info, *value, robot.profile.is.places);
    if (wrong != Misfit::none) return of_parameter(info.name, misfit_text(wrong, info, *value, robot.id));
  }
  return {};
}

}  // namespace trb::resilience
