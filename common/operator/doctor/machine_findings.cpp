#include "common/operator/doctor/machine_findings.hpp"

namespace trb::op {
namespace {

std::string megabytes(std::uint64_t bytes) {
  return std::to_string(bytes / 1'000'000) + " MB";
}

void add_room(const Observed& seen, std::vector<Finding>& out) {
  const DiskState& disk = *seen.disk;
  if (disk.free_bytes < kLittleBytes) {
    const bool full = disk.free_bytes < kFullBytes;
    out.push_back({full ? Weight::problem : Weight::note, full ? "disk_full" : "disk_low", seen.node,
                   megabytes(disk.free_bytes) + " are free where its folder is" +
                       (full ? ": what it cannot store, it does not take" : ""),
                   "make room, " + megabytes(kFullBytes) + " at least: df -h NODE_DIR; " + kOwnFiles});
  }
  if (disk.files != 0 && disk.free_files < kFewFiles) {
    const bool full = disk.free_files < kFullFiles;
    out.push_back({full ? Weight::problem : Weight::note, full ? "no_inodes" : "few_inodes", seen.node,
                   std::to_string(disk.free_files) + " more files can be made where its folder is" +
                       (full ? ": what needs a new file fails" : ""),
                   "remove what makes many small files there: df -i NODE_DIR"});
  }
}

}  // namespace

void add_machine_findings(const Observed& seen, std::vector<Finding>& out) {
  if (seen.disk && seen.disk->read_only) {
    out.push_back({Weight::problem, "disk_read_only", seen.node,
                   "the disk with its folder can be read only: it takes no run, and stores nothing new",
                   "look why (dmesg), then: mount -o remount,rw; Linux does this to a disk that fails"});
  } else if (seen.disk) {
    add_room(seen, out);
  }
  if (seen.clock_set == false) {
    out.push_back({Weight::note, "clock_not_set", seen.node, "nothing has set this computer's clock since it started",
                   "timedatectl set-ntp true; on a network without NTP name a server of its own"});
  }
}

}  // namespace trb::op
