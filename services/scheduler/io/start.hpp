// Puts the service together: configuration, keys, journal, core, loop.
#pragma once

#include "common/config/node_config.hpp"

namespace trb::scheduler {

/// Runs the scheduler of a node until it has to end. Returns the process's exit status.
Result<int> start(NodeConfig node);

}  // namespace trb::scheduler
