// Texts with '*' and '?', as rules write them.
#pragma once

#include <string_view>

namespace trb {

/// True if the whole text matches the pattern: '*' is any number of bytes, '?' is one byte, everything else itself. The
/// time is at most the product of the two sizes.
bool glob_matches(std::string_view pattern, std::string_view text);

}  // namespace trb
