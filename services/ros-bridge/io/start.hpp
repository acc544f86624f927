#pragma once

#include <string>

namespace trb::ros {

/// Runs the ROS bridge of a node until it is told to end. The process's exit status.
int start(const std::string& node_dir);

}  // namespace trb::ros
