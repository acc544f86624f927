// The main of the middleware's services: arguments, the node's folder, and the message when it cannot start.
#pragma once

#include <string_view>

#include "common/base/result.hpp"
#include "common/config/node_config.hpp"
#include "common/config/transports.hpp"

namespace trb {

struct ServiceProgram {
  std::string_view name;     ///< "scheduler": its program is trb-scheduler
  std::string_view purpose;  ///< what it does, in a sentence; for --help
  std::string_view example;  ///< a node's folder
  /// Runs until it is told to end; returns the process's exit status. Errors: whatever prevents the start.
  Result<int> (*run)(NodeConfig node);
  /// What commands.json may name; empty: this service talks to no robot, and does not check that file's transports.
  const Transports& (*transports)() = nullptr;
  /// It needs the interface that leads to the robot: without it, it ends, and `trb up` starts it again until the
  /// interface exists.
  bool needs_robot_address = false;
};

/// 0: it was told to end; 1: it could not start, or lost something it needs, and stderr has the reason; 2: wrong
/// arguments.
int service_main(int argc, char** argv, const ServiceProgram& program);

}  // namespace trb
