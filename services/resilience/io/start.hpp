#pragma once

#include <string>

namespace trb::resilience {

/// Runs the resilience of a node until it is told to end. The process's exit status.
int start(const std::string& node_dir);

}  // namespace trb::resilience
