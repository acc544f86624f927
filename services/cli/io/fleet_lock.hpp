// One process at a time writes in the folder of a fleet's authority.
#pragma once

#include <string>

#include "common/base/result.hpp"

namespace trb::cli {

/// Whoever rewrites the folder holds it from before the folder is read until it is written: what another process has
/// signed meanwhile would be lost. Invitations of one folder may be open side by side: each takes it only to sign.
class FleetLock {
 public:
  /// Waits for whoever has it. Errors: missing, io_error.
  static Result<FleetLock> take(const std::string& fleet_dir);
  FleetLock(FleetLock&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  FleetLock(const FleetLock&) = delete;
  FleetLock& operator=(const FleetLock&) = delete;
  FleetLock& operator=(FleetLock&&) = delete;
  ~FleetLock();

 private:
  explicit FleetLock(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace trb::cli
