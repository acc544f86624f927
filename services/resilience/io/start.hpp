#pragma once

#include "common/config/node_config.hpp"

namespace trb::resilience {

/// Runs the resilience of a node until it is asked to end. The process's exit status.
Result<int> start(NodeConfig node);

}  // namespace trb::resilience
