// Puts the service together: configuration, keys, journal, core, loop.
#pragma once

#include <string>

namespace trb::scheduler {

/// Runs the service in NODE_DIR until it is told to stop; the exit code of the process. Throws what starting may throw.
int start(const std::string& node_dir);

}  // namespace trb::scheduler
