// `trb simulate --replay FILE [--until EVENT]`: a kept trace as a sequence chart, and what was at an event.
#pragma once

#include "services/cli/core/arguments.hpp"

namespace trb::cli {

int run_replay(const Arguments& arguments);

}  // namespace trb::cli
