#include "services/scheduler/io/archive_room.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/base/test/temporary_folder.hpp"
#include "services/scheduler/io/journal_tables.hpp"

using namespace trb;
using namespace trb::scheduler;

namespace {

struct Shelf {
  TemporaryFolder folder;
  std::unique_ptr<SqliteFile> file = std::move(*SqliteFile::open(folder.path + "/journal.db", "a cure"));
  ArchiveRoom room{100};

  Shelf() { REQUIRE(bring_journal_up_to_date(*file, false).ok()); }
  Status put(const std::string& run, const std::string& submitter, std::size_t bytes) {
    const std::string record(bytes, 'r');
    const Status put = file->run("INSERT INTO archive(run, state, until, record, submitter) VALUES(?, 3, 1, ?, ?)", run,
                                 BlobView{record}, submitter);
    REQUIRE(put.ok());
    room.add(submitter, bytes);
    return room.make(*file);
  }
  /// The runs that have a record.
  [[nodiscard]] std::vector<std::string> kept() const {
    std::vector<std::string> out;
    const Status read =
        file->rows("SELECT run FROM archive WHERE record IS NOT NULL ORDER BY seq", [&](const Columns& row) -> Status {
          out.push_back(row.text(0));
          return Done{};
        });
    REQUIRE(read.ok());
    return out;
  }
};

using Runs = std::vector<std::string>;

}  // namespace

TEST_CASE("who has the most makes room, its oldest record first") {
  Shelf archive;
  REQUIRE(archive.put("a", "drone", 30).ok());
  REQUIRE(archive.put("b", "ur3", 40).ok());
  REQUIRE(archive.put("c", "ur3", 30).ok());
  CHECK(archive.kept() == Runs{"a", "b", "c"});
  REQUIRE(archive.put("d", "drone", 20).ok());
  CHECK(archive.kept() == Runs{"a", "c", "d"});
}

TEST_CASE("a record that is larger than the archive makes room by going itself") {
  Shelf archive;
  REQUIRE(archive.put("a", "drone", 101).ok());
  CHECK(archive.kept().empty());
  REQUIRE(archive.put("b", "drone", 100).ok());
  CHECK(archive.kept() == Runs{"b"});
}

TEST_CASE("what the file has is counted anew") {
  Shelf archive;
  REQUIRE(archive.put("a", "drone", 60).ok());
  archive.room.add("drone", 1'000);  // of a transaction that was rolled back
  REQUIRE(archive.room.read(*archive.file).ok());
  REQUIRE(archive.put("b", "ur3", 40).ok());
  CHECK(archive.kept() == Runs{"a", "b"});
}

TEST_CASE("a record that the file does not have is damage, and has a cure") {
  Shelf archive;
  archive.room.add("drone", 101);
  const Status made = archive.room.make(*archive.file);
  REQUIRE_FALSE(made.ok());
  CHECK(made.error().code == Errc::malformed);
  CHECK(made.error().hint == "a cure");
}
