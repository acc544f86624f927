// The capability database's file: full disks, damage, other versions.
#include <sqlite3.h>

#include <fstream>

#include "common/sqlite/test/full_disk.hpp"
#include "services/resilience/core/robot_state.hpp"
#include "services/resilience/io/schema.hpp"
#include "services/resilience/test/db_folder.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

void sql(const Folder& folder, const std::string& text) {
  sqlite3* db = nullptr;
  REQUIRE(sqlite3_open(folder.file().c_str(), &db) == SQLITE_OK);
  char* error = nullptr;
  const int code = sqlite3_exec(db, text.c_str(), nullptr, nullptr, &error);
  CHECK_MESSAGE(code == SQLITE_OK, (error == nullptr ? "" : error));
  sqlite3_close(db);
}

Error refused(const Folder& folder) {
  auto db = CapabilityDb::open(folder.file());
  if (!db) return db.error();
  Fleet fleet;
  const Status loaded = (*db)->load(fleet);
  REQUIRE_FALSE(loaded.ok());
  return loaded.error();
}

}  // namespace

TEST_CASE("a full disk: nothing half, nothing lost, and it goes on once there is room") {
  KeptFleet kept;
  auto& [folder, db, fleet] = kept;
  kept.add("a", mobile_robot());
  REQUIRE(db->write(fleet, at_second(0)));
  for (int i = 0; i < 200; ++i) REQUIRE(fleet.on_route(route_of("r" + std::to_string(i), carrier()), at_second(1)));
  {
    const trb::test::FullDisk full(64 * 1024);
    const Status written = db->write(fleet, at_second(2));
    REQUIRE_FALSE(written.ok());
    CHECK(written.error().code == Errc::io_error);
    CHECK(written.error().text().find("capability.db") != std::string::npos);
    CHECK(written.error().hint == "check the disk's space and the file's rights");
  }
  CHECK_FALSE(fleet.changes().empty());
  CHECK(loaded(*db).robots().size() == 1);
  CHECK(find_candidates(fleet, {{load()}, {}}).robots.size() == 200);  // the index still answers
  REQUIRE(db->write(fleet, at_second(3)));
  CHECK(loaded(*db).robots().size() == 201);
}

TEST_CASE("a file that cannot be opened is named with a cure") {
  const Folder folder;
  std::filesystem::create_directory(folder.file());
  const Error error = refused(folder);
  CHECK(error.code == Errc::io_error);
  CHECK(error.text().find(folder.file()) != std::string::npos);
}

TEST_CASE("a file of a newer build is refused with a cure, and left as it is") {
  const Folder folder;
  opened(folder);
  sql(folder, "PRAGMA user_version=99");
  const Error error = refused(folder);
  CHECK(error.code == Errc::version_mismatch);
  CHECK(error.what.find("schema version 99, this build knows 3") != std::string::npos);
  CHECK(error.hint.find("start the build that wrote it") != std::string::npos);
  CHECK(refused(folder).code == Errc::version_mismatch);
}

TEST_CASE("a damaged file is refused with a cure: no database, a page of it gone, rows that nobody writes") {
  SUBCASE("no database") {
    const Folder folder;
    std::ofstream(folder.file()) << std::string(4096, 'x');
    const Error error = refused(folder);
    CHECK(error.code == Errc::malformed);
    CHECK(error.hint.find("move it away together with its -wal and -shm files") != std::string::npos);
  }
  SUBCASE("pages overwritten") {
    const Folder folder;
    {
      const auto db = opened(folder);
      Fleet fleet;
      for (int i = 0; i < 100; ++i) REQUIRE(fleet.on_route(route_of("r" + std::to_string(i), carrier()), at_second(0)));
      REQUIRE(db->write(fleet, at_second(0)));
    }
    const auto size = std::filesystem::file_size(folder.file());
    REQUIRE(size > 16'384);
    std::fstream file(folder.file(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(4096);
    file << std::string(size - 4096, '\x5a');
    file.close();
    CHECK(refused(folder).code == Errc::malformed);
  }
  SUBCASE("an id that is none") {
    const Folder folder;
    opened(folder);
    sql(folder,
        "INSERT INTO robots(id, framework, mode, transport, maker, model, connection, detail, fenced, control, "
        "told) VALUES('No Id', '', '', '', '', '', '', '', 0, '', 0)");
    CHECK(refused(folder).code == Errc::malformed);
  }
}

TEST_CASE("a file of version 1 becomes one of today, with all that it held") {
  const Folder folder;
  sql(folder, R"(
CREATE TABLE robots(
  id TEXT PRIMARY KEY, framework TEXT NOT NULL, mode TEXT NOT NULL, transport TEXT NOT NULL, maker TEXT NOT NULL,
  model TEXT NOT NULL, connection TEXT NOT NULL, detail TEXT NOT NULL, fenced INTEGER NOT NULL, control TEXT NOT NULL,
  told INTEGER NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE capabilities(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE INDEX capabilities_by_name ON capabilities(name, robot);
CREATE TABLE skills(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  capability TEXT NOT NULL, repeatable INTEGER NOT NULL, timeout_s REAL NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE INDEX skills_by_name ON skills(name, robot);
CREATE TABLE parameters(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, skill INTEGER NOT NULL, place INTEGER NOT NULL,
  name TEXT NOT NULL, type TEXT NOT NULL, required INTEGER NOT NULL, unit TEXT NOT NULL,
  PRIMARY KEY(robot, skill, place)) STRICT, WITHOUT ROWID;
CREATE TABLE places(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, place INTEGER NOT NULL, name TEXT NOT NULL,
  PRIMARY KEY(robot, place)) STRICT, WITHOUT ROWID;
CREATE TABLE sensors(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, plugged INTEGER NOT NULL, place INTEGER NOT NULL,
  name TEXT NOT NULL, kind TEXT NOT NULL, unit TEXT NOT NULL, identity TEXT NOT NULL, device TEXT NOT NULL,
  state INTEGER NOT NULL, detail TEXT NOT NULL,
  PRIMARY KEY(robot, plugged, place)) STRICT, WITHOUT ROWID;
CREATE TABLE state(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, name TEXT NOT NULL, value TEXT NOT NULL,
  told INTEGER NOT NULL,
  PRIMARY KEY(robot, name)) STRICT, WITHOUT ROWID;
CREATE TABLE faults(
  robot TEXT NOT NULL REFERENCES robots(id) ON DELETE CASCADE, capability TEXT NOT NULL, severity INTEGER NOT NULL,
  text TEXT NOT NULL, since INTEGER NOT NULL,
  PRIMARY KEY(robot, capability, severity)) STRICT, WITHOUT ROWID;
INSERT INTO robots VALUES('pioneer1', 'ros', 'ros', 'ros', 'm', 'p3', 'ONLINE', '', 0, '', 5);
INSERT INTO capabilities VALUES('pioneer1', 0, 'mobile');
INSERT INTO skills VALUES('pioneer1', 0, 'go_to', 'mobile', 1, 120.0);
INSERT INTO parameters VALUES('pioneer1', 0, 0, 'place', 'place', 1, '');
INSERT INTO places VALUES('pioneer1', 0, 'dock');
INSERT INTO sensors VALUES('pioneer1', 0, 0, 'battery', '', '', '', '', 0, '');
INSERT INTO state VALUES('pioneer1', 'battery', '0.5', 7);
INSERT INTO faults VALUES('pioneer1', 'mobile', 0, 'battery low', 6);
PRAGMA user_version=1;)");
  const auto db = opened(folder);
  Fleet fleet = loaded(*db);
  REQUIRE(fleet.robots().size() == 1);
  REQUIRE(fleet.on_joined("pioneer1", at_second(0)));
  CHECK(find_candidates(fleet, {{drive("dock")}, {}}).robots == Ids{"pioneer1"});
  CHECK(charge_of(*fleet.find("pioneer1")) == Reported<double>{50, UtcTime{7}});
  CHECK(fleet.find("pioneer1")->faults.size() == 1);
  CHECK(fleet.find("pioneer1")->profile.is.frame == FrameInfo{});
  REQUIRE(db->write(fleet, at_second(1)));
  CHECK(db->history("pioneer1", 10)->size() == 1);
  CHECK(db->put_alert({"a1", at_second(0), 0, "body"}));
}
