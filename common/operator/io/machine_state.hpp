// What the kernel tells of the clock.
#pragma once

#include <optional>

namespace trb::op {

/// Whether something keeps the clock set (adjtimex(2): STA_UNSYNC is not there); empty where the kernel does not tell.
std::optional<bool> is_clock_set();

}  // namespace trb::op
