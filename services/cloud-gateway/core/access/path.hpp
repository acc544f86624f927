// Splits and decodes a request's path once: later code sees no percent sign, no dot segment, no odd byte.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"

namespace trb::gateway {

/// Including the query; ours are below 400.
constexpr std::size_t kMaxTarget = 2048;
constexpr std::size_t kMaxSegments = 8;
constexpr std::size_t kMaxSegment = 96;

/// The decoded segments of a request's target up to its '?'. Errors: malformed, too_large. It refuses a target that
/// does not begin with '/', empty segments ("//", a '/' at the end), "." and "..", encoded or not, wrong escapes, and
/// all decoded bytes except A-Z a-z 0-9 - . _ ~ : @ + , = ! (so also '/', '\', NUL, '%' and non-ASCII).
Result<std::vector<std::string>> split_path(std::string_view target);

}  // namespace trb::gateway
