#pragma once

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb {

/// Lower-case hexadecimal, two digits a byte.
std::string to_hex(BytesView bytes);

/// The inverse; refuses an odd length and any other character (Errc::malformed).
Result<Bytes> from_hex(std::string_view text);

}  // namespace trb
