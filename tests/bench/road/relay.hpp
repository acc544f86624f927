// A process of a bare road: what arrives at one end is sent at the other.
#pragma once

#include "tests/bench/road/ends.hpp"

namespace trb::bench {

/// Runs for ever; throws when an end fails.
[[noreturn]] void relay(End& in, End& out);

}  // namespace trb::bench
