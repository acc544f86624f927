// The robots at both ends of a road, in one process and so on one clock.
#pragma once

#include "tests/bench/road/ends.hpp"

namespace trb::bench {

/// Reads orders from standard input and answers each with a line of JSON, until the input ends:
/// "latency COUNT" (one message in flight) and "throughput SECONDS WINDOW" (WINDOW messages in flight).
void drive(End& out, End& in);

}  // namespace trb::bench
