#include "services/scheduler/io/journal.hpp"

#include <doctest/doctest.h>
#include <sqlite3.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

using namespace trb;
using namespace trb::scheduler;

namespace {

struct Folder {
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "trb-journal-XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file() const { return path + "/journal.db"; }
  std::string path;
};

JournalStart start_of(const std::string& run, const std::string& task) {
  return {{run, task, 1, 1}, 1, 7, 9};
}

Body result_of(const std::string& run) {
  TaskResult result;
  result.key.run = run;
  return JournalResult{{"result", "ur3", {encode(result)}, {"s"}}};
}

Body choice_of(const std::string& run) {
  Choice choice;
  choice.run = run;
  return JournalChoice{{"choice", "ur3", {encode(choice)}, {"s"}}};
}

std::unique_ptr<JournalFile> opened(const Folder& folder) {
  auto file = JournalFile::open(folder.file());
  REQUIRE_MESSAGE(file.ok(), (file ? "" : file.error().text()));
  return std::move(*file);
}

void sql(const Folder& folder, const std::string& text) {
  sqlite3* db = nullptr;
  REQUIRE(sqlite3_open(folder.file().c_str(), &db) == SQLITE_OK);
  CHECK(sqlite3_exec(db, text.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(db);
}

}  // namespace

TEST_CASE("records come back in the order of writing, also after the file is opened again") {
  const Folder folder;
  {
    auto journal = opened(folder);
    CHECK(journal->commit({}).ok());
    CHECK(journal->commit({{start_of("b", "one")}, {result_of("b")}}).ok());
    CHECK(journal->commit({{start_of("a", "two")}, {choice_of("a")}}).ok());
    CHECK(journal->load()->size() == 4);
  }
  const auto records = opened(folder)->load();
  REQUIRE(records.ok());
  REQUIRE(records->size() == 4);
  CHECK(get<JournalStart>((*records)[0]).key == AttemptKey{"b", "one", 1, 1});
  CHECK(get<JournalStart>((*records)[0]).instance == 7);
  CHECK(holds_alternative<JournalResult>((*records)[1]));
  CHECK(get<JournalStart>((*records)[2]).key.run == "a");
  CHECK(holds_alternative<JournalChoice>((*records)[3]));
}

TEST_CASE("a tombstone takes the place of its run's records, until its own time has come") {
  const Folder folder;
  auto journal = opened(folder);
  REQUIRE(journal->commit({{start_of("a", "one")}, {start_of("b", "one")}, {result_of("a")}}).ok());
  REQUIRE(journal->commit({{JournalTombstone{"a", RunState::finished, 100}}}).ok());
  const auto records = journal->load();
  REQUIRE(records->size() == 2);
  CHECK(get<JournalStart>((*records)[0]).key.run == "b");
  CHECK(get<JournalTombstone>((*records)[1]).run == "a");
  CHECK(journal->prune({99}).ok());
  CHECK(journal->load()->size() == 2);
  CHECK(journal->prune({100}).ok());
  CHECK(journal->load()->size() == 1);
}

TEST_CASE("a step is written whole or not at all") {
  const Folder folder;
  auto journal = opened(folder);
  const Status status = journal->commit({{start_of("a", "one")}, {Stop{"no record"}}});
  REQUIRE_FALSE(status.ok());
  CHECK(status.error().code == Errc::bad_value);
  CHECK(journal->load()->empty());
  CHECK(journal->commit({{start_of("a", "one")}}).ok());
  CHECK(journal->load()->size() == 1);
}

TEST_CASE("a torn record is refused, with the file's name and a cure") {
  const Folder folder;
  REQUIRE(opened(folder)->commit({{start_of("a", "one")}, {result_of("a")}}).ok());
  sql(folder, "UPDATE records SET body = substr(body, 1, 20) WHERE seq = 2");
  const auto records = opened(folder)->load();
  REQUIRE_FALSE(records.ok());
  CHECK(records.error().code == Errc::malformed);
  CHECK(records.error().what.find(folder.file()) != std::string::npos);
  CHECK(records.error().what.find("record 2") != std::string::npos);
  CHECK_FALSE(records.error().cure.empty());
}

TEST_CASE("a record of an unknown kind, another schema, and a file that is no database are refused") {
  const Folder folder;
  REQUIRE(opened(folder)->commit({{start_of("a", "one")}}).ok());
  sql(folder, "UPDATE records SET kind = 'journal_of_tomorrow'");
  CHECK(opened(folder)->load().error().code == Errc::malformed);
  sql(folder, "PRAGMA user_version = 9");
  const auto later = JournalFile::open(folder.file());
  REQUIRE_FALSE(later.ok());
  CHECK(later.error().code == Errc::version_mismatch);
  const Folder other;
  std::ofstream(other.file()) << "this has never been a database, whatever its name says, has it not?\n";
  const auto text = JournalFile::open(other.file());
  REQUIRE_FALSE(text.ok());
  CHECK(text.error().code == Errc::malformed);
  CHECK(JournalFile::open(folder.path + "/none/journal.db").error().code == Errc::io_error);
}
