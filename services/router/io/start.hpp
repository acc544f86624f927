#pragma once

#include "common/config/node_config.hpp"

namespace trb::router {

/// Reads the node's keys, counts the boot, opens the doors and runs until it is told to end; the process's exit status.
Result<int> start(NodeConfig node);

}  // namespace trb::router
