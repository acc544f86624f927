#pragma once

#include "common/base/result.hpp"
#include "proto/body.hpp"

namespace trb::op {

/// The error that a Nack carries: its code and text; if it names no hint, the usual one for that code. A code of a
/// newer version is bad_value, and stands in the text.
Error nack_error(const Nack& nack);

}  // namespace trb::op
