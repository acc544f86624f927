// What a task requires of a robot, and whether a robot's skill accepts it. The scenario's check, its binding and the
// search for a replacement all use this.
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
  std::string task;                       ///< its id, for use in texts
  std::string skill;                      ///< of the same name; empty: only the capabilities
  std::vector<std::string> capabilities;  ///< in addition to the one that the skill itself needs
  Value::Object arguments;                ///< the parameters that are given, by name
  /// Parameters whose values come from a future result: the skill must have them, their values are not checked.
  std::vector<std::string> later;
  std::vector<std::string> tried{};  ///< robots that have failed it: never candidates
};

/// A task's data. Error: malformed (not a JSON object).
Result<Value> parameters_of(const Task& task);

/// For a scenario's task: skill, `requires`, values, and its data as parameters_of() returns it.
TaskNeed need_of(const Task& task, const Value& data);
/// The same. Error: malformed (the data is not a JSON object).
Result<TaskNeed> need_of(const Task& task);

/// One parameter of a skill that the task gives wrongly or not at all. Refers to the need and to the skill.
struct ParameterFault {
  const ParameterInfo& info;
  const Value* value;  ///< the given value; nullptr: it is missing, though required
  Misfit misfit;       ///< of the value; none: it is missing
};

/// In the order of the skill's parameters. `places` are those that the robot knows.
std::vector<ParameterFault> parameter_faults(const TaskNeed& need, const SkillInfo& skill,
                                             const std::vector<std::string>& places);

/// Names that the task gives but the skill does not have: of its arguments, then of `later`.
std::vector<std::string_view> unknown_parameters(const TaskNeed& need, const SkillInfo& skill);

/// The robot's skill of that name, or nullptr.
const SkillInfo* find_skill(const NodeProfile& profile, std::string_view name);

/// The robot has the skill, and its skill accepts what the task gives. Its present capabilities are not checked here:
/// the caller, who knows of faults, knows better than the profile.
bool takes_task(const TaskNeed& need, const NodeProfile& profile);

}  // namespace trb
