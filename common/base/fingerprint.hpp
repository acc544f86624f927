// A certificate's SHA-256 as people compare it: "AB:CD:...".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/bytes.hpp"

namespace trb {

std::string to_fingerprint(BytesView digest);

/// 32 bytes in hexadecimal, with or without colons, as to_fingerprint writes them; nothing: it is none.
std::optional<std::string> read_fingerprint(std::string_view text);

}  // namespace trb
