// What a task asks of whoever does it, and whether a robot's skill takes it. The scenario's check, its binding and the
// search for a replacement all go by this.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/scenario/parameters.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run.hpp"
#include "proto/value.hpp"

namespace trb {

struct TaskNeed {
  std::string task;                       ///< its id, for the reasons
  std::string skill;                      ///< of the same name; empty: only the capabilities
  std::vector<std::string> capabilities;  ///< beyond the one that the skill itself needs
  Value::Object arguments;                ///< the parameters that are given, by name
  /// Parameters whose values come from a result that is not there yet: they must exist, their values are not checked.
  std::vector<std::string> later;
  std::vector<std::string> tried{};  ///< robots that have failed it: no candidates, whatever they can do
};

/// A task's data. Error: malformed (no JSON object).
Result<Value> parameters_of(const Task& task);

/// Of a scenario's task: skill, `requires`, values, and its data as parameters_of() gives it.
TaskNeed need_of(const Task& task, const Value& data);
/// The same. Error: malformed (the data is no JSON object).
Result<TaskNeed> need_of(const Task& task);

/// One parameter of a skill that the task does not give as it should. Refers to the need and to the skill.
struct ParameterFault {
  const ParameterInfo& info;
  const Value* value;  ///< what is given; nullptr: nothing is, though it is required
  Misfit misfit;       ///< of the value; none: it is missing
};

/// In the order of the skill's parameters. `places` are those that the robot knows.
std::vector<ParameterFault> parameter_faults(const TaskNeed& need, const SkillInfo& skill,
                                             const std::vector<std::string>& places);

/// Names that the task gives and the skill does not have: of its arguments, then of what comes later.
std::vector<std::string_view> unknown_parameters(const TaskNeed& need, const SkillInfo& skill);

/// The robot's skill of that name; nullptr: it has none.
const SkillInfo* find_skill(const NodeProfile& profile, std::string_view name);

/// The robot has the skill, and its skill takes what the task gives. Which capabilities it has now is not asked here:
/// who knows of faults knows better than the profile.
bool takes_task(const TaskNeed& need, const NodeProfile& profile);

}  // namespace trb
