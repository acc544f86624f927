#pragma once

#include "common/config/node_config.hpp"

namespace trb::sensor {

/// Runs the sensor-bus of a node until it is told to end. The process's exit status.
Result<int> start(NodeConfig node);

}  // namespace trb::sensor
