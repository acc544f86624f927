#include "services/cli/io/fleet_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "common/base/files.hpp"

namespace trb::cli {

Result<FleetLock> FleetLock::take(const std::string& fleet_dir) {
  Descriptor folder(::open(fleet_dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder && errno == ENOENT)
    return fail(Errc::missing, fleet_dir + ": no such folder", "name the folder of trb fleet init");
  int failed = !folder ? -1 : ::flock(folder.get(), LOCK_EX);
  while (folder && failed != 0 && errno == EINTR) failed = ::flock(folder.get(), LOCK_EX);
  if (failed == 0) {
    remove_unfinished_files(fleet_dir);
    return FleetLock(std::move(folder));
  }
  return fail(Errc::io_error, fleet_dir + ": cannot be locked: " + std::strerror(errno),
              "name the folder of trb fleet init, on a file system that has locks");
}

}  // namespace trb::cli
