// Does a value fit a skill's parameter?
#pragma once

#include <string>
#include <vector>

#include "proto/bodies/link.hpp"
#include "proto/value.hpp"

namespace trb {

/// What is wrong with a value. Made into text only on request: a thousand robots may be searched.
enum class Misfit : std::uint8_t { none = 0, type, range, count, place, word };

/// `places` are those that the robot knows. A type that this build does not know is accepted: the robot's node checks
/// it.
Misfit misfit_of(const ParameterInfo& info, const Value& value, const std::vector<std::string>& places);

/// "3 is over 1 m/s", "'dok' is no place that 'r1' knows"; `robot` is the intended robot.
std::string misfit_text(Misfit misfit, const ParameterInfo& info, const Value& value, const std::string& robot);

/// What to do about it.
std::string misfit_cure(Misfit misfit, const ParameterInfo& info, const Value& value,
                        const std::vector<std::string>& places);

/// What may be named: a place that the skill takes and the robot knows, or a word of the parameter. Empty: anything, or
/// nothing that is known.
std::vector<std::string> choices_of(const ParameterInfo& info, const std::vector<std::string>& places);

/// The expected value: "\"speed\": a number from 0 to 1 m/s".
std::string wanted_text(const ParameterInfo& info);

}  // namespace trb
