// A process of a bare road: what comes in at one end goes out at the other.
#pragma once

#include "tests/bench/road/ends.hpp"

namespace trb::bench {

/// Runs for ever; throws when an end breaks.
[[noreturn]] void relay(End& in, End& out);

}  // namespace trb::bench
