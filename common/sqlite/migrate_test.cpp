// The versions of a file's tables.
#include "common/sqlite/migrate.hpp"

#include <doctest/doctest.h>

#include <array>

#include "common/base/test/temporary_folder.hpp"

using namespace trb;

namespace {

constexpr std::array kFirst{"CREATE TABLE a(x INTEGER NOT NULL) STRICT; INSERT INTO a VALUES(7)"};
constexpr std::array kSecond{kFirst[0], "ALTER TABLE a ADD COLUMN y INTEGER NOT NULL DEFAULT 8"};
constexpr std::array kTorn{kFirst[0], "DELETE FROM a; CREATE TABLE b(x INTEGER) STRICT; SELEC"};

std::unique_ptr<SqliteFile> at(const TemporaryFolder& folder) {
  auto file = SqliteFile::open(folder.path + "/a.db", "");
  REQUIRE(file);
  return std::move(*file);
}

std::int64_t number(SqliteFile& file, const char* sql) {
  std::int64_t out = -1;
  CHECK(file.rows(sql, [&](const Columns& row) -> Status {
    out = row.integer(0);
    return Done{};
  }));
  return out;
}

}  // namespace

TEST_CASE("an empty file gets every step, one of an older build only those that it lacks") {
  const TemporaryFolder folder;
  const auto file = at(folder);
  REQUIRE(migrate(*file, kFirst, "cure"));
  REQUIRE(migrate(*file, kFirst, "cure"));
  REQUIRE(migrate(*at(folder), kSecond, "cure"));
  CHECK(number(*file, "SELECT x + y FROM a") == 15);
  CHECK(number(*file, "PRAGMA user_version") == 2);
}

TEST_CASE("a file of a newer build is refused with the cure, and left as it is") {
  const TemporaryFolder folder;
  const auto file = at(folder);
  REQUIRE(migrate(*file, kSecond, "cure"));
  const Status older = migrate(*file, kFirst, "start the newer build");
  REQUIRE_FALSE(older);
  CHECK(older.error().code == Errc::version_mismatch);
  CHECK(older.error().what.find("a.db: schema version 2, this build knows 1") != std::string::npos);
  CHECK(older.error().hint == "start the newer build");
  CHECK(number(*file, "PRAGMA user_version") == 2);
}

TEST_CASE("a step that fails changes nothing") {
  const TemporaryFolder folder;
  const auto file = at(folder);
  REQUIRE(migrate(*file, kFirst, "cure"));
  CHECK_FALSE(migrate(*file, kTorn, "cure"));
  CHECK(number(*file, "PRAGMA user_version") == 1);
  CHECK(number(*file, "SELECT count(*) FROM a") == 1);
  CHECK(number(*file, "SELECT count(*) FROM sqlite_master WHERE name = 'b'") == 0);
}
