// Bytes in zlib's form (RFC 1950), for what travels once and is regular.
#pragma once

#include <cstddef>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb {

Bytes deflated(BytesView bytes);

/// Errors: malformed (it is none, is cut, or has bytes behind it), too_large (it would have more than `most` bytes;
/// no more are ever written).
Result<Bytes> inflated(BytesView bytes, std::size_t most);

}  // namespace trb
