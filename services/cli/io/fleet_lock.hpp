// One process at a time takes a serial number from a fleet's folder.
#pragma once

#include <string>

#include "common/base/result.hpp"

namespace trb::cli {

/// Held until it is destroyed; waits for whoever has it. Invitations of one folder may be open side by side.
class FleetLock {
 public:
  explicit FleetLock(const std::string& fleet_dir);
  ~FleetLock();
  FleetLock(const FleetLock&) = delete;
  FleetLock& operator=(const FleetLock&) = delete;

 private:
  int fd_;
};

}  // namespace trb::cli
