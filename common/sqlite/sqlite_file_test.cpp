// A SQLite file: rows, values of each type, transactions, damage.
#include "common/sqlite/sqlite_file.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <vector>

#include "common/base/test/temporary_folder.hpp"

using namespace trb;

namespace {

constexpr const char* kCure = "bring the copy back";
constexpr const char* kThings = "CREATE TABLE things(number INTEGER PRIMARY KEY, name TEXT NOT NULL) STRICT";
constexpr const char* kInsert = "INSERT INTO things VALUES(?, ?)";

std::unique_ptr<SqliteFile> opened(const TemporaryFolder& folder) {
  auto file = SqliteFile::open(folder.path + "/a.db", kCure);
  REQUIRE_MESSAGE(file.ok(), (file ? "" : file.error().text()));
  return std::move(*file);
}

std::unique_ptr<SqliteFile> with_things(const TemporaryFolder& folder) {
  auto file = opened(folder);
  REQUIRE(file->script(kThings));
  return file;
}

std::vector<std::string> names(SqliteFile& file) {
  std::vector<std::string> out;
  const Status read = file.rows("SELECT name FROM things ORDER BY number", [&](const Columns& row) -> Status {
    out.push_back(row.text(0));
    return Done{};
  });
  CHECK(read);
  return out;
}

/// What is read of SELECT ?.
template <class T, class Value>
T back(SqliteFile& file, const Value& value, T (Columns::*read)(int) const) {
  T out{};
  const Status done = file.rows(
      "SELECT ?",
      [&](const Columns& row) -> Status {
        out = (row.*read)(0);
        return Done{};
      },
      value);
  CHECK(done);
  return out;
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("rows are written and read in order, also by another connection") {
  const TemporaryFolder folder;
  const auto file = with_things(folder);
  REQUIRE(file->run(kInsert, std::int64_t{2}, "b"));
  REQUIRE(file->run(kInsert, std::int64_t{1}, "a"));
  CHECK(file->changed() == 1);
  CHECK(names(*file) == Names{"a", "b"});
  CHECK(names(*opened(folder)) == Names{"a", "b"});
  CHECK(file->path() == folder.path + "/a.db");
}

TEST_CASE("a value of each type comes back as it was") {
  const TemporaryFolder folder;
  const auto file = opened(folder);
  const std::string zeros("a\0b'; DROP TABLE x; --\0", 23);
  CHECK(back(*file, zeros, &Columns::text) == zeros);
  CHECK(back(*file, BlobView{zeros}, &Columns::text) == zeros);
  CHECK(back(*file, "a literal", &Columns::text) == "a literal");
  constexpr std::int64_t kLowest = std::numeric_limits<std::int64_t>::min();
  CHECK(back(*file, kLowest, &Columns::integer) == kLowest);
  CHECK(back(*file, std::uint32_t{4'000'000'000}, &Columns::integer) == 4'000'000'000);
  CHECK(back(*file, true, &Columns::integer) == 1);
  CHECK(back(*file, 0.1, &Columns::real) == 0.1);
  CHECK(back(*file, std::optional<std::int64_t>(7), &Columns::integer) == 7);
}

TEST_CASE("an empty text or blob is not NULL, an empty optional is, and no value of the last call stays bound") {
  const TemporaryFolder folder;
  const auto file = opened(folder);
  CHECK_FALSE(back(*file, std::string_view(), &Columns::is_null));
  CHECK_FALSE(back(*file, BlobView{}, &Columns::is_null));
  CHECK(back(*file, std::optional<std::int64_t>(), &Columns::is_null));
}

TEST_CASE("an error of the reader ends the reading, and the statement can be used again") {
  const TemporaryFolder folder;
  const auto file = with_things(folder);
  for (std::int64_t i = 0; i < 3; ++i) REQUIRE(file->run(kInsert, i, "x"));
  int rows = 0;
  const Status read = file->rows("SELECT name FROM things ORDER BY number", [&](const Columns&) -> Status {
    ++rows;
    return fail(Errc::bad_value, "enough");
  });
  CHECK(read.error().code == Errc::bad_value);
  CHECK(rows == 1);
  CHECK(names(*file).size() == 3);
}

TEST_CASE("a transaction writes all or nothing, and one within it is part of it") {
  const TemporaryFolder folder;
  const auto file = with_things(folder);
  const auto put = [&](std::int64_t number) { return file->run(kInsert, number, "x"); };
  const Status failed = file->transact([&]() -> Status {
    if (auto done = put(1); !done) return done;
    return file->transact([&]() -> Status {
      if (auto done = put(2); !done) return done;
      return fail(Errc::bad_value, "no");
    });
  });
  CHECK(failed.error().code == Errc::bad_value);
  CHECK(names(*file).empty());
  const Status later = file->transact([&]() -> Status {
    const Status within = file->transact([&] { return put(1); });
    return within ? Status(fail(Errc::bad_value, "no")) : within;
  });
  CHECK_FALSE(later);
  CHECK(names(*file).empty());
  CHECK(file->transact([&] { return put(1); }));
  CHECK(names(*opened(folder)).size() == 1);
}

TEST_CASE("what the tables refuse is a conflict; the file can be used further") {
  const TemporaryFolder folder;
  const auto file = with_things(folder);
  REQUIRE(file->run(kInsert, std::int64_t{1}, "a"));
  const Status twice = file->run(kInsert, std::int64_t{1}, "b");
  REQUIRE_FALSE(twice);
  CHECK(twice.error().code == Errc::conflict);
  CHECK(twice.error().what.find("a.db") != std::string::npos);
  CHECK_FALSE(twice.error().hint.empty());
  CHECK(names(*file) == Names{"a"});
}

TEST_CASE("a statement that SQLite does not understand is an error with the file's name") {
  const TemporaryFolder folder;
  const auto file = opened(folder);
  CHECK(file->run("SELEC 1").error().what.find("a.db") != std::string::npos);
  CHECK_FALSE(file->script("SELEC 1"));
}

TEST_CASE("while another connection writes, the wait is bounded and the hint says so") {
  const TemporaryFolder folder;
  const auto file = with_things(folder);
  const auto other = opened(folder);
  const Status outer = other->transact([&]() -> Status {
    const Status waits = file->run(kInsert, std::int64_t{1}, "a");
    CHECK(waits.error().code == Errc::io_error);
    CHECK(waits.error().hint.find("another process") != std::string::npos);
    return Done{};
  });
  CHECK(outer);
  CHECK(file->run(kInsert, std::int64_t{1}, "a"));
}

TEST_CASE("a damaged file is malformed, with the hint; one that cannot be opened is an io_error") {
  const TemporaryFolder folder;
  SUBCASE("no database") {
    std::ofstream(folder.path + "/a.db") << std::string(4096, 'x');
    const auto file = SqliteFile::open(folder.path + "/a.db", kCure);
    REQUIRE_FALSE(file);
    CHECK(file.error().code == Errc::malformed);
    CHECK(file.error().hint == kCure);
    CHECK(file.error().what.find("a.db") != std::string::npos);
  }
  SUBCASE("pages overwritten") {
    {
      const auto file = with_things(folder);
      REQUIRE(file->transact([&]() -> Status {
        for (std::int64_t i = 0; i < 1000; ++i) CHECK(file->run(kInsert, i, std::string(100, 'x')));
        return Done{};
      }));
    }
    const auto size = std::filesystem::file_size(folder.path + "/a.db");
    REQUIRE(size > 16'384);
    std::fstream(folder.path + "/a.db", std::ios::in | std::ios::out | std::ios::binary).seekp(4096)
        << std::string(size - 4096, '\x5a');
    const Status read = opened(folder)->rows("SELECT sum(length(name)) FROM things", nullptr);
    REQUIRE_FALSE(read);
    CHECK(read.error().code == Errc::malformed);
    CHECK(read.error().hint == kCure);
  }
  SUBCASE("a folder in its place") {
    std::filesystem::create_directory(folder.path + "/a.db");
    CHECK(SqliteFile::open(folder.path + "/a.db", kCure).error().code == Errc::io_error);
  }
}
