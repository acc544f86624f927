#include "common/operator/io/machine_state.hpp"

#include <sys/statvfs.h>
#include <sys/timex.h>

namespace trb::op {

std::optional<DiskState> disk_state(const std::string& folder) {
  struct statvfs told {};
  if (::statvfs(folder.c_str(), &told) != 0) return std::nullopt;
  // As a service has it: without what is kept for root.
  return DiskState{std::uint64_t{told.f_bavail} * told.f_frsize, told.f_favail, told.f_files,
                   (told.f_flag & ST_RDONLY) != 0};
}

std::optional<bool> is_clock_set() {
  timex asked{};
  if (::adjtimex(&asked) == -1) return std::nullopt;
  return (asked.status & STA_UNSYNC) == 0;
}

}  // namespace trb::op
