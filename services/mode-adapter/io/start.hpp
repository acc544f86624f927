#pragma once

#include "common/config/node_config.hpp"

namespace trb::adapter {

/// Opens the service and the robot's connections, and runs until it is told to end; returns the process's exit status.
Result<int> start(NodeConfig node);

}  // namespace trb::adapter
