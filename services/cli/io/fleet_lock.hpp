// One process at a time writes in the folder of a fleet's authority.
#pragma once

#include <string>
#include <utility>

#include "common/base/descriptor.hpp"
#include "common/base/result.hpp"

namespace trb::cli {

/// Whoever rewrites the folder holds it from before the folder is read until it is written: what another process has
/// signed meanwhile would be lost. Invitations of one folder may be open side by side: each takes it only to sign.
class FleetLock {
 public:
  /// Waits for whoever has it. Errors: missing, io_error.
  static Result<FleetLock> take(const std::string& fleet_dir);

 private:
  explicit FleetLock(Descriptor folder) : folder_(std::move(folder)) {}
  Descriptor folder_;
};

}  // namespace trb::cli
