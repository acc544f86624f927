// The main of the middleware's services: arguments, the node's folder, and what is said of why nothing is started.
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
  /// Runs until it is told to end; the process's exit status. Errors: whatever keeps it from starting.
  Result<int> (*run)(NodeConfig node);
  /// What commands.json may name; empty: this service speaks to no robot, and takes the file as it is.
  const Transports& (*transports)() = nullptr;
  /// It waits for the interface that leads to the robot: it ends, and `trb up` starts it again until that is there.
  bool needs_robot_address = false;
};

/// 0: it was told to end; 1: it could not start, or lost what it needs, and said why on stderr; 2: wrong arguments.
int service_main(int argc, char** argv, const ServiceProgram& program);

}  // namespace trb
