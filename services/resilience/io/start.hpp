#pragma once

#include "common/config/node_config.hpp"

namespace trb::resilience {

/// Runs the resilience service of a node until it has to end. Returns the process's exit status.
Result<int> start(NodeConfig node);

}  // namespace trb::resilience
