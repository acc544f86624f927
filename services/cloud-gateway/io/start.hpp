#pragma once

#include "common/base/result.hpp"
#include "common/config/node_config.hpp"

namespace trb::gateway {

/// Runs the gateway of that node until it is told to end. Errors: whatever prevents the start.
Result<int> start(NodeConfig config);

}  // namespace trb::gateway
