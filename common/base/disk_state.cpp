#include "common/base/disk_state.hpp"

#include <sys/statvfs.h>

namespace trb {
namespace {

Error full(const std::string& folder, const std::string& what, const std::string& command) {
  return fail(Errc::queue_full, "the disk of " + folder + " is full: " + what,
              "make room: " + command + " " + folder + "; it goes on by itself");
}

}  // namespace

std::optional<DiskState> disk_state(const std::string& folder) {
  struct statvfs told {};
  if (::statvfs(folder.c_str(), &told) != 0) return std::nullopt;
  // As a service has it: without what is kept for root.
  return DiskState{std::uint64_t{told.f_bavail} * told.f_frsize, told.f_favail, told.f_files,
                   (told.f_flag & ST_RDONLY) != 0};
}

Status takes_more(const DiskState& disk, const std::string& folder) {
  if (disk.read_only) {
    return fail(Errc::queue_full, "the disk of " + folder + " can be read only",
                "look why (dmesg), then: mount -o remount,rw; it goes on by itself");
  }
  if (disk.free_bytes < kFullBytes) {
    return full(
        folder,
        std::to_string(disk.free_bytes / 1000) + " kB are free, " + std::to_string(kFullBytes / 1000) + " must be",
        "df -h");
  }
  if (disk.files != 0 && disk.free_files < kFullFiles) {
    return full(folder, std::to_string(disk.free_files) + " more files can be made", "df -i");
  }
  return Done{};
}

std::string note_of_room(const DiskState& disk, const std::string& folder) {
  if (const Status room = takes_more(disk, folder); !room) return room.error().what + "; " + room.error().hint;
  if (disk.free_bytes >= kLittleBytes) return "";
  return std::to_string(disk.free_bytes / 1'000'000) + " MB are left on the disk of " + folder + "; below " +
         std::to_string(kFullBytes / 1'000'000) + " MB it takes no run: df -h " + folder;
}

}  // namespace trb
