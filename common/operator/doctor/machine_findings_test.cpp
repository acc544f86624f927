// What the doctor says of the node's computer.
#include "common/operator/doctor/machine_findings.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::op;

namespace {

std::vector<Finding> with(const DiskState& disk, std::optional<bool> clock_set = true) {
  Observed seen;
  seen.node = "ant";
  seen.disk = disk;
  seen.clock_set = clock_set;
  std::vector<Finding> out;
  add_machine_findings(seen, out);
  return out;
}

constexpr DiskState kRoom{1'000'000'000, 1'000'000, 2'000'000, false};

bool is_one(const std::vector<Finding>& found, Weight weight, const std::string& cause) {
  return found.size() == 1 && found[0].weight == weight && found[0].cause == cause && found[0].subject == "ant";
}

}  // namespace

TEST_CASE("room on the disk and a clock that is set: nothing to say") {
  CHECK(with(kRoom).empty());
}

TEST_CASE("a disk that is full is a problem, one that will be is a note") {
  DiskState disk = kRoom;
  disk.free_bytes = kLittleBytes - 1;
  CHECK(is_one(with(disk), Weight::note, "disk_low"));
  disk.free_bytes = kFullBytes;
  CHECK(is_one(with(disk), Weight::note, "disk_low"));
  disk.free_bytes = kFullBytes - 1;
  CHECK(is_one(with(disk), Weight::problem, "disk_full"));
  // Who frees less than is needed waits in vain.
  CHECK(with(disk)[0].hint.find("8 MB at least") != std::string::npos);
}

TEST_CASE("a disk that takes no more files, though it has room") {
  DiskState disk = kRoom;
  disk.free_files = kFewFiles - 1;
  CHECK(is_one(with(disk), Weight::note, "few_inodes"));
  disk.free_files = 0;
  CHECK(is_one(with(disk), Weight::problem, "no_inodes"));
}

TEST_CASE("a file system that does not count its files has enough of them") {
  DiskState disk = kRoom;
  disk.files = disk.free_files = 0;
  CHECK(with(disk).empty());
}

TEST_CASE("a disk that can only be read: its room does not matter") {
  CHECK(is_one(with({0, 0, 0, true}), Weight::problem, "disk_read_only"));
}

TEST_CASE("a clock that nothing has set is a note; a computer that does not tell is not accused") {
  CHECK(is_one(with(kRoom, false), Weight::note, "clock_not_set"));
  CHECK(with(kRoom, std::nullopt).empty());
}
