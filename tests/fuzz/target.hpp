// A fuzz target: a parser and the state machine behind it, fed with anything.
#pragma once

#include <vector>

#include "common/base/bytes.hpp"

namespace trb::fuzz {

/// Well-formed inputs from which mutation starts; the same at every call within a process.
std::vector<Bytes> seeds();

/// Takes any bytes. Ends the process if an invariant is broken.
void run(BytesView input);

/// Ends the process and names the invariant.
void require(bool holds, const char* invariant);

}  // namespace trb::fuzz
