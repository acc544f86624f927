// The path of a request, taken apart once: whoever is behind it sees no percent sign, no dot segment, no odd byte.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::gateway {

/// With its query; ours are below 400.
constexpr std::size_t kMaxTarget = 2048;
constexpr std::size_t kMaxSegments = 8;
constexpr std::size_t kMaxSegment = 96;

/// The segments of a request's target up to its '?', decoded. Errors: malformed, too_large. Refused are: what does not
/// begin with '/', empty segments ("//", a '/' at the end), "." and "..", encoded or not, wrong escapes, and
/// whatever is, once decoded, none of A-Z a-z 0-9 - . _ ~ : @ + , = ! so also '/', '\', NUL, '%' and all beyond ASCII.
Result<std::vector<std::string>> split_path(std::string_view target);

}  // namespace trb::gateway
