// What a node's services have logged.
#pragma once

#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// `trb logs NODE_DIR [SERVICE]`.
int run_logs(const Arguments& arguments);

}  // namespace trb::cli
