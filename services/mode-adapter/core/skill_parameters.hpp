#pragma once

#include <map>
#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "common/fleet/description.hpp"

namespace trb::adapter {

/// The parameters of a call by name, defaults filled in, each of the declared type and within its bounds.
using Arguments = std::map<std::string, Value, std::less<>>;

/// Errors: malformed (not a JSON object), unknown_key, missing, bad_value; each names the parameter.
Result<Arguments> read_arguments(const Skill& skill, std::string_view parameters);

}  // namespace trb::adapter
