#include "services/scheduler/io/journal.hpp"
#include "common/base/test/temporary_folder.hpp"

#include <doctest/doctest.h>
#include <sqlite3.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "common/base/hex.hpp"

using namespace trb;
using namespace trb::scheduler;

namespace {

struct Folder : TemporaryFolder {
  [[nodiscard]] std::string file() const { return path + "/journal.db"; }
};

JournalStart start_of(const std::string& run, const std::string& task) {
  return {{run, task, 1, 1}, 1, 7, 9};
}

JournalResult result_of(const std::string& run) {
  TaskResult result;
  result.key.run = run;
  return {{"result", "ur3", {encode(result)}, {"s"}}};
}

JournalChoice choice_of(const std::string& run) {
  Choice choice;
  choice.run = run;
  return {{"choice", "ur3", {encode(choice)}, {"s"}}};
}

JournalArchive over_of(const std::string& run, RunState state, std::int64_t until) {
  JournalArchive out;
  out.view.run = run;
  out.view.state = state;
  out.view.waits_for = "nothing";
  out.view.tasks.resize(1);
  if (state == RunState::finished) out.end = {"run_end", "cloud", {"payload"}, {"s"}};
  out.until = until;
  return out;
}

constexpr std::int64_t kPlenty = 1 << 20;  ///< bytes of the archive: none of these records is removed

std::unique_ptr<JournalFile> opened(const Folder& folder) {
  auto file = JournalFile::open(folder.file(), kPlenty);
  REQUIRE_MESSAGE(file.ok(), (file ? "" : file.error().text()));
  return std::move(*file);
}

void sql(const Folder& folder, const std::string& text) {
  sqlite3* db = nullptr;
  REQUIRE(sqlite3_open(folder.file().c_str(), &db) == SQLITE_OK);
  CHECK(sqlite3_exec(db, text.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(db);
}

/// What the query answers.
std::int64_t number(const Folder& folder, const std::string& query) {
  sqlite3* db = nullptr;
  sqlite3_stmt* statement = nullptr;
  REQUIRE(sqlite3_open(folder.file().c_str(), &db) == SQLITE_OK);
  REQUIRE(sqlite3_prepare_v2(db, query.c_str(), -1, &statement, nullptr) == SQLITE_OK);
  REQUIRE(sqlite3_step(statement) == SQLITE_ROW);
  const std::int64_t out = sqlite3_column_int64(statement, 0);
  sqlite3_finalize(statement);
  sqlite3_close(db);
  return out;
}

/// How SQLite carries out the query.
std::string plan_of(const Folder& folder, const std::string& query) {
  sqlite3* db = nullptr;
  REQUIRE(sqlite3_open(folder.file().c_str(), &db) == SQLITE_OK);
  sqlite3_stmt* plan = nullptr;
  REQUIRE(sqlite3_prepare_v2(db, ("EXPLAIN QUERY PLAN " + query).c_str(), -1, &plan, nullptr) == SQLITE_OK);
  std::string out;
  while (sqlite3_step(plan) == SQLITE_ROW) out += reinterpret_cast<const char*>(sqlite3_column_text(plan, 3));
  sqlite3_finalize(plan);
  sqlite3_close(db);
  return out;
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
  CHECK(std::get<JournalStart>((*records)[0]).key == AttemptKey{"b", "one", 1, 1});
  CHECK(std::get<JournalStart>((*records)[0]).instance == 7);
  CHECK(std::holds_alternative<JournalResult>((*records)[1]));
  CHECK(std::get<JournalStart>((*records)[2]).key.run == "a");
  CHECK(std::holds_alternative<JournalChoice>((*records)[3]));
}

TEST_CASE(
    "a run that is over leaves its records for the archive, which is read by its id, its beginning and in pages") {
  const Folder folder;
  {
    auto journal = opened(folder);
    REQUIRE(journal->commit({{start_of("a1", "one")}, {start_of("b1", "one")}, {result_of("a1")}}).ok());
    REQUIRE(journal->commit({{over_of("a1", RunState::finished, 100)}}).ok());
    REQUIRE(journal->commit({{over_of("a2", RunState::expired, 200)}}).ok());
  }
  const auto journal = opened(folder);
  const auto records = journal->load();
  REQUIRE(records->size() == 1);
  CHECK(std::get<JournalStart>((*records)[0]).key.run == "b1");
  CHECK(journal->over("a1")->state == RunState::finished);
  CHECK(journal->over("a1")->end.kind == "run_end");
  CHECK(journal->over("a2")->end.kind.empty());
  CHECK_FALSE(journal->over("b1"));
  CHECK(journal->record("a1")->view.waits_for == "nothing");
  CHECK_FALSE(journal->record("b1"));
  CHECK(journal->ids("a", 9) == std::vector<std::string>{"a2", "a1"});
  CHECK(journal->ids("", 1) == std::vector<std::string>{"a2"});
  CHECK(journal->ids("a1", 9) == std::vector<std::string>{"a1"});
  const ArchivePage first = journal->page("", 1);
  REQUIRE(first.runs.size() == 1);
  CHECK(first.runs[0].run == "a2");
  CHECK(first.runs[0].state == RunState::expired);
  CHECK(first.runs[0].tasks == 1);
  CHECK(first.more);
  const ArchivePage second = journal->page("a2", 1);
  REQUIRE(second.runs.size() == 1);
  CHECK(second.runs[0].run == "a1");
  CHECK_FALSE(second.more);
}

TEST_CASE("the archive keeps within its bytes: the oldest records go, and that their runs are over stays known") {
  const Folder folder;
  constexpr std::int64_t kBytes = 4000;
  {
    auto file = JournalFile::open(folder.file(), kBytes);
    REQUIRE(file.ok());
    for (int i = 100; i < 200; ++i) {
      REQUIRE((*file)->commit({{over_of(std::to_string(i), RunState::finished, i)}}).ok());
    }
    CHECK((*file)->page("", 100).runs.size() < 60);
    CHECK((*file)->page("", 100).runs.size() > 10);
    CHECK((*file)->record("199"));
    CHECK_FALSE((*file)->record("100"));
    CHECK((*file)->over("100")->state == RunState::finished);
    REQUIRE((*file)->commit({{JournalTime{149}}}).ok());
    CHECK_FALSE((*file)->over("149"));
    CHECK((*file)->over("150"));
  }
  // Opened with fewer bytes, it makes room at the next run.
  auto file = JournalFile::open(folder.file(), kBytes / 10);
  REQUIRE(file.ok());
  REQUIRE((*file)->commit({{over_of("200", RunState::finished, 300)}}).ok());
  CHECK((*file)->page("", 100).runs.size() < 6);
  CHECK((*file)->over("199"));
}

TEST_CASE("a run with more results than a message takes comes back whole") {
  const Folder folder;
  JournalArchive over = over_of("a", RunState::finished, 100);
  over.results.assign(4, {"result", "ur3", {Bytes(1U << 19U, 'x')}, {"s"}});
  auto file = JournalFile::open(folder.file(), 1 << 22);
  REQUIRE(file.ok());
  REQUIRE((*file)->commit({{over}}).ok());
  const auto record = (*file)->record("a");
  REQUIRE(record);
  CHECK(record->results == over.results);
}

TEST_CASE("an archived record that is damaged is told from one that has made room") {
  const Folder folder;
  const auto journal = opened(folder);
  REQUIRE(journal->commit({{over_of("a", RunState::finished, 100)}, {over_of("b", RunState::finished, 100)}}).ok());
  sql(folder, "UPDATE archive SET record = substr(record, 1, 20) WHERE run = 'a'");
  sql(folder, "UPDATE archive SET record = NULL WHERE run = 'b'");
  const Error damaged = journal->record("a").error();
  CHECK(damaged.code == Errc::io_error);
  CHECK(damaged.what.starts_with(folder.file() + ": the record of run a is damaged: "));
  CHECK_FALSE(damaged.hint.empty());
  CHECK(journal->record("b").error().code == Errc::missing);
  CHECK(journal->record("c").error().code == Errc::missing);
  sql(folder, "DROP TABLE archive");
  CHECK(journal->record("a").error().code == Errc::io_error);
}

TEST_CASE("who has the most in the archive makes room: nobody pushes out the others' records") {
  const Folder folder;
  auto file = JournalFile::open(folder.file(), 4000);
  REQUIRE(file.ok());
  const auto put = [&](const std::string& submitter, int i) {
    JournalArchive over = over_of(submitter + std::to_string(i), RunState::finished, 1000);
    over.view.submitter = submitter;
    REQUIRE((*file)->commit({{over}}).ok());
  };
  for (int i = 0; i < 5; ++i) put("cloud", i);
  for (int i = 0; i < 200; ++i) put("drone", i);
  for (int i = 0; i < 5; ++i) CHECK((*file)->record("cloud" + std::to_string(i)));
  CHECK((*file)->record("drone199"));
  CHECK_FALSE((*file)->record("drone100"));
  file->reset();
  file = JournalFile::open(folder.file(), 2000);
  REQUIRE(file.ok());
  put("drone", 200);
  for (int i = 0; i < 5; ++i) CHECK((*file)->record("cloud" + std::to_string(i)));
}

TEST_CASE("a submitter whose runs have left too much behind begins no other before their time has come; others do") {
  const Folder folder;
  const auto journal = opened(folder);
  CHECK(journal->has_room("drone").ok());
  sql(folder,
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 16384) "
      "INSERT INTO archive(run, state, until, submitter) SELECT 'd' || i, 3, 100, 'drone' FROM n");
  const Status full = journal->has_room("drone");
  REQUIRE_FALSE(full.ok());
  CHECK(full.error().code == Errc::queue_full);
  CHECK_FALSE(full.error().hint.empty());
  CHECK(journal->has_room("cloud").ok());
  REQUIRE(journal->commit({{JournalTime{100}}}).ok());
  CHECK(journal->has_room("drone").ok());
}

TEST_CASE("a file of an earlier build learns who has submitted its runs, and that build goes on with it") {
  const Folder folder;
  JournalArchive over = over_of("a", RunState::finished, 1);
  over.view.submitter = "drone";
  REQUIRE(opened(folder)->commit({{over}}).ok());
  const std::string earlier =
      "DROP INDEX archive_of_submitter; DROP INDEX archive_without_record;"
      "ALTER TABLE archive DROP COLUMN submitter";
  sql(folder, earlier);
  CHECK(opened(folder)->record("a").ok());
  sql(folder,
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 250) "
      "INSERT INTO archive(run, state, until, final, summary, record) "
      "SELECT 'b' || i, state, until, final, summary, record FROM archive, n");
  CHECK(opened(folder)->record("b250").ok());
  CHECK(number(folder, "SELECT COUNT(*) FROM archive WHERE submitter = 'drone'") == 251);
  const std::string oldest =
      "SELECT seq, LENGTH(record) FROM archive WHERE record IS NOT NULL AND submitter = 'drone' ORDER BY seq LIMIT 1";
  CHECK(plan_of(folder, oldest) == "SEARCH archive USING INDEX archive_of_submitter (submitter=?)");
  auto file = JournalFile::open(folder.file(), 1);
  REQUIRE(file.ok());
  REQUIRE((*file)->commit({{over_of("c", RunState::finished, 1)}}).ok());
  CHECK_FALSE((*file)->record("a"));
  CHECK_FALSE((*file)->record("b1"));
}

TEST_CASE("of the time the newest is kept, and so of the word that a journal was lost") {
  const Folder folder;
  auto journal = opened(folder);
  REQUIRE(journal->commit({{JournalTime{1}}, {JournalLost{2, false}}}).ok());
  REQUIRE(journal->commit({{JournalTime{3}}, {JournalLost{4, true}}}).ok());
  const auto records = journal->load();
  REQUIRE(records->size() == 2);
  CHECK(std::get<JournalTime>((*records)[0]).steady == 3);
  CHECK(std::get<JournalLost>((*records)[1]).over);
}

TEST_CASE("a journal that is gone is told from one that never was") {
  const Folder folder;
  CHECK_FALSE(opened(folder)->was_lost());
  CHECK_FALSE(opened(folder)->was_lost());
  for (const char* tail : {"", "-wal", "-shm"}) std::filesystem::remove(folder.file() + tail);
  {
    const auto journal = opened(folder);
    CHECK(journal->was_lost());
    REQUIRE(journal->load()->size() == 1);
    CHECK_FALSE(std::get<JournalLost>(journal->load()->front()).over);
  }
  CHECK_FALSE(opened(folder)->was_lost());
  CHECK(opened(folder)->load()->size() == 1);
}

TEST_CASE("a file of the version before is brought up to date: its tombstones are over") {
  const Folder folder;
  REQUIRE(opened(folder)->commit({{start_of("b", "one")}}).ok());
  const std::string tombstone = to_hex(encode_record(JournalTombstone{"a", RunState::aborted, 100}));
  sql(folder, "DROP TABLE archive; INSERT INTO records(run, kind, body) VALUES('a', 'journal_tombstone', x'" +
                  tombstone + "'); PRAGMA user_version = 1");
  const auto journal = opened(folder);
  CHECK(journal->load()->size() == 1);
  CHECK(journal->over("a")->state == RunState::aborted);
  CHECK_FALSE(journal->record("a"));
  REQUIRE(journal->commit({{JournalTime{100}}}).ok());
  CHECK_FALSE(journal->over("a"));
}

TEST_CASE("a file that an earlier build has written is read: its rows as they stand on disk") {
  const Folder folder;
  REQUIRE(opened(folder)->load()->empty());
  sql(folder,
      "INSERT INTO records(run, kind, body) VALUES"
      "('r', 'journal_start', x'9494a172a174010203cd012cfa'),"
      "('r', 'journal_delivered', x'95a172a3757233a56261746f6e92010203'),"
      "('', 'journal_time', x'9105'), ('', 'journal_lost', x'9205c3');"
      "INSERT INTO archive(run, state, until, final, summary, record) VALUES('r', 3, 7, x'', x'',"
      "x'979fa172a003a001a00000909000a000cb0000000000000000009090909094a0a0c400c40007')");
  const auto journal = opened(folder);
  const auto records = journal->load();
  REQUIRE(records.ok());
  REQUIRE(records->size() == 4);
  CHECK(std::get<JournalStart>((*records)[0]).key == AttemptKey{"r", "t", 1, 2});
  CHECK(std::get<JournalDelivered>((*records)[1]).what == "baton");
  CHECK(std::get<JournalTime>((*records)[2]).steady == 5);
  CHECK(std::get<JournalLost>((*records)[3]).over);
  REQUIRE(journal->record("r"));
  CHECK(journal->record("r")->view.state == RunState::finished);
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
  CHECK_FALSE(records.error().hint.empty());
}

TEST_CASE("a record of an unknown kind, another schema, and a file that is no database are refused") {
  const Folder folder;
  REQUIRE(opened(folder)->commit({{start_of("a", "one")}}).ok());
  sql(folder, "UPDATE records SET kind = 'journal_of_tomorrow'");
  CHECK(opened(folder)->load().error().code == Errc::malformed);
  sql(folder, "PRAGMA user_version = 9");
  const auto later = JournalFile::open(folder.file(), kPlenty);
  REQUIRE_FALSE(later.ok());
  CHECK(later.error().code == Errc::version_mismatch);
  const Folder other;
  std::ofstream(other.file()) << "this has never been a database, whatever its name says, has it not?\n";
  const auto text = JournalFile::open(other.file(), kPlenty);
  REQUIRE_FALSE(text.ok());
  CHECK(text.error().code == Errc::malformed);
  CHECK(JournalFile::open(folder.path + "/none/journal.db", kPlenty).error().code == Errc::io_error);
}

TEST_CASE("whether a run is over is not told by a file that cannot be read: its tasks would begin a second time") {
  const Folder folder;
  REQUIRE(opened(folder)->commit({{over_of("a", RunState::finished, 100)}}).ok());
  SUBCASE("a page is damaged") {
    // That of the ids: what is read at the start is whole.
    const auto page = number(folder, "SELECT rootpage FROM sqlite_master WHERE name = 'sqlite_autoindex_archive_1'");
    const auto size = number(folder, "PRAGMA page_size");
    std::fstream file(folder.file(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp((page - 1) * size);
    file << std::string(static_cast<std::size_t>(size), '\xff');
    REQUIRE(file.flush());
  }
  const auto journal = opened(folder);
  SUBCASE("the table is gone") {
    sql(folder, "DROP TABLE archive");
  }
  for (const char* run : {"a", "b"}) {
    std::string said;
    try {
      (void)journal->over(run);
    } catch (const std::runtime_error& problem) {
      said = problem.what();
    }
    CHECK(said.find(folder.file() + ": whether run " + run + " is over cannot be read") != std::string::npos);
  }
}
