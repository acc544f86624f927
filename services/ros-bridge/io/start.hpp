#pragma once

#include "common/config/node_config.hpp"

namespace trb::ros {

/// Runs the ROS bridge of a node until it is told to end. The process's exit status.
Result<int> start(NodeConfig node);

}  // namespace trb::ros
