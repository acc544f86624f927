// Do the values that a task gives fit a robot's skill?
#pragma once

#include <string>

#include "services/resilience/core/candidates.hpp"

namespace trb::resilience {

/// What is wrong with the parameters, for a person: "parameter 'speed': 3 is over 1 m/s"; empty: nothing. A type that
/// this build does not know is taken as it is: the robot's node checks it.
std::string misfit(const SkillInfo& skill, const TaskNeed& need, const RobotRecord& robot);

}  // namespace trb::resilience
