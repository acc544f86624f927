// A skill with its parameters, as the data of the command that starts it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/fleet/description.hpp"
#include "common/fleet/places.hpp"

namespace trb::adapter {

/// How values are written: for the field channel as words or as bare numbers, for commands.json as JSON.
enum class CallStyle : std::uint8_t { words, numbers, json };

struct SkillCall {
  std::string data;
  std::vector<double> target;  ///< for an end by position: where to, in the robot's frame and units
};

/// `parameters` is a JSON object, or empty. Parameters are checked; places and SI units are converted to the robot's
/// own. Errors: malformed, missing, unknown_key, bad_value, unknown_place; each names the parameter.
Result<SkillCall> render_call(const Skill& skill, std::string_view parameters, const Description& description,
                              const Places& places, CallStyle style);

}  // namespace trb::adapter
