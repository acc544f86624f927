#include "services/cli/io/fleet_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace trb::cli {

FleetLock::FleetLock(const std::string& fleet_dir)
    : fd_(::open(fleet_dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (fd_ >= 0) (void)::flock(fd_, LOCK_EX);
}

FleetLock::~FleetLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace trb::cli
