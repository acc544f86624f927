#include "services/cli/io/fleet_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace trb::cli {

Result<FleetLock> FleetLock::take(const std::string& fleet_dir) {
  FleetLock lock(::open(fleet_dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (lock.fd_ < 0 && errno == ENOENT)
    return fail(Errc::missing, fleet_dir + ": no such folder", "name the folder of trb fleet init");
  int failed = lock.fd_ < 0 ? -1 : ::flock(lock.fd_, LOCK_EX);
  while (lock.fd_ >= 0 && failed != 0 && errno == EINTR) failed = ::flock(lock.fd_, LOCK_EX);
  if (failed == 0) return Result<FleetLock>(std::move(lock));
  return fail(Errc::io_error, fleet_dir + ": cannot be locked: " + std::strerror(errno),
              "name the folder of trb fleet init, on a file system that has locks");
}

FleetLock::~FleetLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace trb::cli
