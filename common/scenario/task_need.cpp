#include "common/scenario/task_need.hpp"

#include <algorithm>
#include <optional>

namespace trb {
namespace {

const Value* given(const TaskNeed& need, const std::string& name) {
  const auto at = std::ranges::find(need.arguments, name, [](const auto& argument) { return argument.first; });
  return at == need.arguments.end() ? nullptr : &at->second;
}

bool comes_later(const TaskNeed& need, const std::string& name) {
  return std::ranges::find(need.later, name) != need.later.end();
}

bool has_parameter(const SkillInfo& skill, const std::string& name) {
  return std::ranges::find(skill.parameters, name, &ParameterInfo::name) != skill.parameters.end();
}

std::optional<ParameterFault> fault_of(const TaskNeed& need, const ParameterInfo& info,
                                       const std::vector<std::string>& places) {
  if (const Value* value = given(need, info.name)) {
    const Misfit misfit = misfit_of(info, *value, places);
    return misfit == Misfit::none ? std::nullopt : std::optional(ParameterFault{info, value, misfit});
  }
  if (!info.required || comes_later(need, info.name)) return std::nullopt;
  return ParameterFault{info, nullptr, Misfit::none};
}

}  // namespace

Result<Value> parameters_of(const Task& task) {
  auto parsed = parse_json(task.data.empty() ? "{}" : task.data);
  if (parsed && parsed->is_object()) return parsed;
  return fail(Errc::malformed, "is no JSON object", R"(write the skill's parameters as { "NAME": VALUE, … })");
}

TaskNeed need_of(const Task& task, const Value& data) {
  TaskNeed need{task.id, task.skill, task.requires_, data.object(), {}};
  for (const ValueFrom& value : task.values) need.later.push_back(value.parameter);
  return need;
}

Result<TaskNeed> need_of(const Task& task) {
  const auto data = parameters_of(task);
  if (data) return need_of(task, *data);
  return fail(Errc::malformed, "task '" + task.id + "': its data " + data.error().what);
}

std::vector<ParameterFault> parameter_faults(const TaskNeed& need, const SkillInfo& skill,
                                             const std::vector<std::string>& places) {
  std::vector<ParameterFault> out;
  for (const ParameterInfo& info : skill.parameters) {
    if (const auto fault = fault_of(need, info, places)) out.push_back(*fault);
  }
  return out;
}

std::vector<std::string_view> unknown_parameters(const TaskNeed& need, const SkillInfo& skill) {
  std::vector<std::string_view> out;
  const auto check = [&](const std::string& name) {
    if (!has_parameter(skill, name)) out.push_back(name);
  };
  for (const auto& [name, ignored] : need.arguments) check(name);
  for (const std::string& name : need.later) check(name);
  return out;
}

const SkillInfo* find_skill(const NodeProfile& profile, std::string_view name) {
  const auto at = std::ranges::find(profile.skills, name, &SkillInfo::name);
  return at == profile.skills.end() ? nullptr : &*at;
}

bool takes_task(const TaskNeed& need, const NodeProfile& profile) {
  if (need.skill.empty()) return true;
  const SkillInfo* skill = find_skill(profile, need.skill);
  // Without making a list of the faults: a thousand robots may be searched.
  return skill != nullptr && unknown_parameters(need, *skill).empty() &&
         std::ranges::none_of(skill->parameters, [&](const ParameterInfo& info) {
           return fault_of(need, info, profile.places).has_value();
         });
}

}  // namespace trb
