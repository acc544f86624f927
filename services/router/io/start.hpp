#pragma once

#include <string>

namespace trb::router {

/// Reads the node's folder and keys, counts the boot, opens the doors and runs. Returns the process's exit status.
int start(const std::string& node_dir);

}  // namespace trb::router
