// drive: a robot by hand, for a while.
#pragma once

#include "services/cli/core/arguments.hpp"

namespace trb::cli {

int run_drive(const Arguments& arguments);

}  // namespace trb::cli
