#pragma once

#include "common/base/result.hpp"
#include "proto/body.hpp"

namespace trb::op {

/// The error in a Nack: its code and text; without a hint, the usual one for that code. An unknown code of a newer
/// version becomes bad_value, and is put into the text.
Error nack_error(const Nack& nack);

}  // namespace trb::op
