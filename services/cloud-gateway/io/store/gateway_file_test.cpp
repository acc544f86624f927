// The store's file: rights, full disks, damage, other versions.
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/audit/audit_verify.hpp"
#include "common/base/test/closed_folder.hpp"
#include "common/sqlite/test/full_disk.hpp"
#include "services/cloud-gateway/io/store/test/store_folder.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

unsigned mode_of(const std::string& path) {
  struct stat is {};
  REQUIRE(::stat(path.c_str(), &is) == 0);
  return is.st_mode & 0777U;
}

void do_sql(const StoreFolder& folder, const char* sql) {
  sqlite3* db = nullptr;
  REQUIRE(sqlite3_open(folder.file().c_str(), &db) == SQLITE_OK);
  CHECK(sqlite3_exec(db, sql, nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(db);
}

/// The error of opening it, or of loading what is in it.
Error no_store(const StoreFolder& folder) {
  auto db = GatewayDb::open(folder.file());
  if (!db) return db.error();
  const auto state = (*db)->load();
  REQUIRE_FALSE(state.ok());
  return state.error();
}

}  // namespace

TEST_CASE("the file belongs to its owner alone, and so do the files beside it") {
  const StoreFolder folder;
  const mode_t former = ::umask(0);
  {
    const auto db = opened(folder);
    AuditChain chain(chain_start());
    REQUIRE(db->save(audit_batch(records(chain, 1))));
    for (const char* end : {"", "-wal", "-shm"}) CHECK(mode_of(folder.file() + end) == 0600);
  }
  ::umask(former);
  REQUIRE(::chmod(folder.file().c_str(), 0644) == 0);
  CHECK(loaded(*opened(folder)).last_audit);
  CHECK(mode_of(folder.file()) == 0600);
}

TEST_CASE("a full disk: nothing half, nothing lost, and it goes on once there is room") {
  const StoreFolder folder;
  const auto db = opened(folder);
  AuditChain chain(chain_start());
  REQUIRE(db->save(audit_batch(records(chain, 2))));
  const std::vector<AuditRow> many = records(chain, 2000);
  {
    const trb::test::FullDisk full(64 * 1024);
    const Error error = refused(*db, audit_batch(many));
    CHECK(error.code == Errc::io_error);
    CHECK(error.what.find("gateway.db") != std::string::npos);
    CHECK(error.hint == "check the disk's space and the file's rights");
    CHECK(loaded(*db).last_audit->record.number == 2);
  }
  REQUIRE(db->save(audit_batch(many)));
  const auto rows = *opened(folder)->audit_from(1, 10'000);
  CHECK(verify_audit(chain_start(), rows, {}).good == 2002);
}

TEST_CASE("a folder that cannot be written, or is not there, is named with a cure") {
  const StoreFolder folder;
  {
    const ClosedFolder nobody(folder.path, 0555);
    const Error error = no_store(folder);
    CHECK(error.code == Errc::io_error);
    CHECK(error.what.find(folder.file()) != std::string::npos);
    CHECK_FALSE(error.hint.empty());
  }
  CHECK(GatewayDb::open(folder.path + "/none/gateway.db").error().code == Errc::io_error);
  std::filesystem::create_directory(folder.file());
  const unsigned mode = mode_of(folder.file());
  CHECK(no_store(folder).code == Errc::io_error);
  CHECK(mode_of(folder.file()) == mode);
}

TEST_CASE("an empty file is a store of version 0, and becomes one of today") {
  const StoreFolder folder;
  std::ofstream(folder.file()).flush();
  const auto db = opened(folder);
  AuditChain chain(chain_start());
  CHECK(db->save(audit_batch(records(chain, 1))));
}

TEST_CASE("a file of a newer build is refused with a cure, and left as it is") {
  const StoreFolder folder;
  opened(folder);
  do_sql(folder, "PRAGMA user_version=99");
  const Error error = no_store(folder);
  CHECK(error.code == Errc::version_mismatch);
  CHECK(error.what.find("schema version 99, this build knows 4") != std::string::npos);
  CHECK(error.hint.find("start the build that wrote it") != std::string::npos);
  do_sql(folder, "PRAGMA user_version=4");
  CHECK(GatewayDb::open(folder.file()));
}

TEST_CASE("a file of the first build is brought up to date, and keeps what it has") {
  const StoreFolder folder;
  {
    StoreBatch batch;
    batch.users = {put(user_of("ann", UserRole::admin))};
    REQUIRE(opened(folder)->save(batch));
  }
  do_sql(
      folder,
      "DROP TABLE scenarios; DROP TABLE acknowledged; DROP TABLE shelves; ALTER TABLE users DROP COLUMN must_change; "
      "PRAGMA user_version=1");
  const auto db = opened(folder);
  StoreBatch batch;
  batch.scenarios = {{"a1", StoredScenario{"a1", {"{}", "one", 0}, 1, "ann", {1}}}};
  REQUIRE(db->save(batch));
  CHECK(loaded(*db).users == std::vector<User>{user_of("ann", UserRole::admin)});
  CHECK(loaded(*db).scenarios.size() == 1);
}

TEST_CASE("a damaged file is refused with a cure: no database, rows that nobody writes") {
  const StoreFolder folder;
  SUBCASE("no database") {
    std::ofstream(folder.file()) << std::string(4096, 'x');
  }
  SUBCASE("a role that is none") {
    opened(folder);
    do_sql(folder, "INSERT INTO users VALUES('eve', 3, '', 0, 0, x'', 0)");
  }
  SUBCASE("a token's role that is none") {
    opened(folder);
    do_sql(folder, "INSERT INTO tokens VALUES('eve', -1, 0, '', 0, 0, x'')");
  }
  SUBCASE("a scenario of no version") {
    opened(folder);
    do_sql(folder, "INSERT INTO scenarios VALUES('a1', '{}', '', 0, 0, '', 0)");
  }
  SUBCASE("a status that is none") {
    opened(folder);
    do_sql(folder, "INSERT INTO requests VALUES('ann', 'k', x'', '', 0, 65536, x'')");
  }
  SUBCASE("a severity that is none") {
    opened(folder);
    do_sql(folder, "INSERT INTO acknowledged VALUES('a1', 'ann', 0, 9)");
  }
  const Error error = no_store(folder);
  CHECK(error.code == Errc::malformed);
  CHECK(error.hint.find("move it away together with its -wal and -shm files") != std::string::npos);
}
