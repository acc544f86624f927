#pragma once

#include "common/config/node_config.hpp"

namespace trb::router {

/// Reads the node's keys, counts the boot, opens the sockets and runs until it has to end; returns the exit status.
Result<int> start(NodeConfig node);

}  // namespace trb::router
