#pragma once

#include <string>

namespace trb::adapter {

/// Checks the node's folder, opens the service and the robot's connections, and runs. Returns the exit code.
int start(const std::string& node_dir);

}  // namespace trb::adapter
