// When a disk takes no new work.
#include "common/base/disk_state.hpp"

#include <doctest/doctest.h>

#include "common/base/test/temporary_folder.hpp"

using namespace trb;

TEST_CASE("a disk with less than some minutes' room takes no new work, and says what is short") {
  DiskState disk{kFullBytes, kFullFiles, 1'000, false};
  CHECK(takes_more(disk, "/n/state"));
  disk.free_bytes -= 1;
  const Status bytes = takes_more(disk, "/n/state");
  REQUIRE_FALSE(bytes);
  CHECK(bytes.error().code == Errc::queue_full);
  CHECK(bytes.error().what == "the disk of /n/state is full: 7999 kB are free, 8000 must be");
  CHECK(bytes.error().hint.find("df -h /n/state") != std::string::npos);
  disk = {kFullBytes, kFullFiles - 1, 1'000, false};
  const Status files = takes_more(disk, "/n/state");
  REQUIRE_FALSE(files);
  CHECK(files.error().what == "the disk of /n/state is full: 15 more files can be made");
  CHECK(files.error().hint.find("df -i /n/state") != std::string::npos);
}

TEST_CASE("a disk that can be read only takes no new work") {
  const Status status = takes_more({kFullBytes, 0, 0, true}, "/n");
  REQUIRE_FALSE(status);
  CHECK(status.error().what == "the disk of /n can be read only");
}

TEST_CASE("a file system that counts no files is not full of them") {
  CHECK(takes_more({kFullBytes, 0, 0, false}, "/n"));
}

TEST_CASE("a folder's disk is read, and a folder that is not there has none") {
  const TemporaryFolder folder;
  CHECK(disk_state(folder.path)->free_bytes > 0);
  CHECK_FALSE(disk_state(folder.path + "/none"));
}

TEST_CASE("little room is noted before there is none") {
  CHECK(note_of_room({kLittleBytes, 0, 0, false}, "/n").empty());
  CHECK(note_of_room({kLittleBytes - 1, 0, 0, false}, "/n") ==
        "199 MB are left on the disk of /n; below 8 MB it takes no run: df -h /n");
  CHECK(note_of_room({kFullBytes - 1, 0, 0, false}, "/n").starts_with("the disk of /n is full: "));
}
