#include "services/scheduler/io/journal.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "common/base/bytes.hpp"
#include "common/base/disk_state.hpp"
#include "common/base/files.hpp"
#include "common/log/log.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb::scheduler {
namespace {

constexpr const char* kKnown = ".known";
constexpr std::size_t kNamedAtOnce = 100;  ///< rows of an earlier version in a transaction
constexpr const char* kInsert = "INSERT INTO records(run, kind, body) VALUES(?, ?, ?)";
constexpr const char* kTables =
    "CREATE TABLE IF NOT EXISTS records("
    "seq INTEGER PRIMARY KEY AUTOINCREMENT, run TEXT NOT NULL, kind TEXT NOT NULL, body BLOB NOT NULL);"
    "CREATE INDEX IF NOT EXISTS records_of_run ON records(run);"
    "CREATE TABLE IF NOT EXISTS archive("
    "seq INTEGER PRIMARY KEY AUTOINCREMENT, run TEXT NOT NULL UNIQUE, state INTEGER NOT NULL, until INTEGER NOT NULL,"
    "final BLOB, summary BLOB, record BLOB);"
    "CREATE INDEX IF NOT EXISTS archive_of_until ON archive(until) WHERE record IS NULL;";
/// A submitter's oldest record is looked for at each run that is over, and runs without a record are many.
constexpr const char* kSubmitterIndexes =
    "CREATE INDEX IF NOT EXISTS archive_of_submitter ON archive(submitter, seq) WHERE record IS NOT NULL;"
    "CREATE INDEX IF NOT EXISTS archive_without_record ON archive(submitter) WHERE record IS NULL;";

void bind_text(sqlite3_stmt* statement, int place, std::string_view text) {
  sqlite3_bind_text(statement, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

void bind_bytes(sqlite3_stmt* statement, int place, const Bytes& bytes) {
  sqlite3_bind_blob(statement, place, bytes.data(), static_cast<int>(bytes.size()), SQLITE_TRANSIENT);
}

std::string column(sqlite3_stmt* statement, int place) {
  const void* bytes = sqlite3_column_blob(statement, place);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, place));
  return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
}

}  // namespace

Result<std::unique_ptr<JournalFile>> JournalFile::open(const std::string& path, std::int64_t archive_bytes) {
  sqlite3* db = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  std::unique_ptr<JournalFile> file(new JournalFile(path, db, archive_bytes));
  if (code != SQLITE_OK) return file->problem("cannot be opened");
  if (auto ready = file->prepare(); !ready) return ready.error();
  if (auto noted = file->note_known(); !noted) return noted.error();
  return file;
}

JournalFile::~JournalFile() {
  insert_.reset();
  drop_run_.reset();
  sqlite3_close_v2(db_);
}

Status JournalFile::note_known() {
  if (file_exists(path_ + kKnown)) return Done{};
  return write_file(path_ + kKnown, "Without this file a missing journal.db beside it counts as a first start.\n");
}

Status JournalFile::prepare() {
  sqlite3_busy_timeout(db_, 1000);
  for (const char* sql : {"PRAGMA journal_mode=WAL", "PRAGMA synchronous=FULL"}) {
    if (auto set = run(sql); !set) return set;
  }
  if (auto current = bring_up_to_date(); !current) return current;
  struct Wanted {
    Statement& statement;
    const char* sql;
  };
  const Wanted all[] = {{insert_, kInsert}, {drop_run_, "DELETE FROM records WHERE run = ?"}};
  for (const Wanted& wanted : all) {
    auto compiled = compile(wanted.sql);
    if (!compiled) return compiled.error();
    wanted.statement = std::move(*compiled);
  }
  return read_sizes();
}

Status JournalFile::read_sizes() {
  auto read = compile("SELECT submitter, SUM(LENGTH(record)) FROM archive WHERE record IS NOT NULL GROUP BY submitter");
  if (!read) return read.error();
  archived_ = 0;
  sizes_.clear();
  int code = SQLITE_OK;
  while ((code = sqlite3_step(read->get())) == SQLITE_ROW) {
    const std::int64_t bytes = sqlite3_column_int64(read->get(), 1);
    sizes_[column(read->get(), 0)] = bytes;
    archived_ += bytes;
  }
  return code == SQLITE_DONE ? Status(Done{}) : Status(damaged(sqlite3_errmsg(db_)));
}

Status JournalFile::bring_up_to_date() {
  const auto version = number("PRAGMA user_version");
  if (!version) return damaged("its version cannot be read");
  if (*version > kSchemaVersion) {
    return fail(
        Errc::version_mismatch,
        path_ + ": schema version " + std::to_string(*version) + ", this build knows " + std::to_string(kSchemaVersion),
        "start the build that wrote it, or move the file away once its runs are over");
  }
  if (auto begun = run("BEGIN IMMEDIATE"); !begun) return begun;
  Status made = run(kTables);
  // In one transaction with the tables: a crash in between is not taken for a first start.
  lost_ = *version == 0 && file_exists(path_ + kKnown);
  if (made && lost_) made = note_lost();
  if (made && *version == 1) made = move_tombstones();
  if (made) made = add_submitters();
  if (made) made = run(("PRAGMA user_version=" + std::to_string(kSchemaVersion)).c_str());
  if (made) made = run("COMMIT");
  if (!made) sqlite3_exec(db_, "ROLLBACK", nullptr, nullptr, nullptr);
  return made ? name_submitters() : made;
}

Status JournalFile::note_lost() {
  auto statement = compile(kInsert);
  if (!statement) return statement.error();
  bind_text(statement->get(), 1, "");
  bind_text(statement->get(), 2, JournalLost::kKind);
  bind_bytes(statement->get(), 3, encode_record(JournalLost{}));
  return finish(statement->get());
}

/// Version 1 kept the runs that are over as tombstone records, and nothing else of them.
Status JournalFile::move_tombstones() {
  auto read = compile("SELECT seq, kind, body FROM records WHERE kind = 'journal_tombstone' ORDER BY seq");
  if (!read) return read.error();
  auto write = compile("INSERT OR REPLACE INTO archive(run, state, until) VALUES(?, ?, ?)");
  if (!write) return write.error();
  while (sqlite3_step(read->get()) == SQLITE_ROW) {
    const auto record = read_record(read->get());
    if (!record) return record.error();
    const auto& is = std::get<JournalTombstone>(*record);
    bind_text(write->get(), 1, is.run);
    sqlite3_bind_int64(write->get(), 2, static_cast<std::int64_t>(is.state));
    sqlite3_bind_int64(write->get(), 3, is.until);
    if (auto written = finish(write->get()); !written) return written;
  }
  return run("DELETE FROM records WHERE kind = 'journal_tombstone'");
}

/// An earlier version does not know the column, reads the file all the same, and writes rows without it.
Status JournalFile::add_submitters() {
  const auto known = number("SELECT COUNT(*) FROM pragma_table_info('archive') WHERE name = 'submitter'");
  if (!known) return known.error();
  if (*known == 0) {
    if (auto added = run("ALTER TABLE archive ADD COLUMN submitter TEXT"); !added) return added;
  }
  return run(kSubmitterIndexes);
}

/// To name a row's submitter moves its record: few rows a transaction, so that no disk needs room for all at once.
Status JournalFile::name_submitters() {
  for (std::size_t named = kNamedAtOnce; named == kNamedAtOnce;) {
    if (auto begun = run("BEGIN IMMEDIATE"); !begun) return begun;
    const auto some = name_some();
    const Status done = some ? run("COMMIT") : Status(some.error());
    if (!done) {
      sqlite3_exec(db_, "ROLLBACK", nullptr, nullptr, nullptr);
      return done;
    }
    named = *some;
  }
  return Done{};
}

Result<std::size_t> JournalFile::name_some() {
  auto read = compile("SELECT seq, record FROM archive WHERE record IS NOT NULL AND submitter IS NULL LIMIT 1");
  if (!read) return read.error();
  auto write = compile("UPDATE archive SET submitter = ? WHERE seq = ?");
  if (!write) return write.error();
  std::size_t named = 0;
  for (; named < kNamedAtOnce && sqlite3_step(read->get()) == SQLITE_ROW; ++named) {
    const auto record = decode_record(JournalArchive::kKind, column(read->get(), 1));
    const auto* is = record ? std::get_if<JournalArchive>(&*record) : nullptr;  // a damaged one is nobody's
    bind_text(write->get(), 1, is == nullptr ? std::string() : is->view.submitter);
    sqlite3_bind_int64(write->get(), 2, sqlite3_column_int64(read->get(), 0));
    sqlite3_reset(read->get());
    if (auto written = finish(write->get()); !written) return written.error();
  }
  return named;
}

Result<std::int64_t> JournalFile::number(const char* sql) {
  auto statement = compile(sql);
  if (!statement) return statement.error();
  if (sqlite3_step(statement->get()) != SQLITE_ROW) return damaged(sqlite3_errmsg(db_));
  return sqlite3_column_int64(statement->get(), 0);
}

Status JournalFile::run(const char* sql) {
  const int code = sqlite3_exec(db_, sql, nullptr, nullptr, nullptr);
  if (code == SQLITE_OK) return Done{};
  return code == SQLITE_NOTADB || code == SQLITE_CORRUPT ? damaged(sqlite3_errmsg(db_)) : problem(sql);
}

Result<JournalFile::Statement> JournalFile::compile(const char* sql) const {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(db_, sql, -1, &statement, nullptr) != SQLITE_OK) return problem(sql);
  return Statement(statement, sqlite3_finalize);
}

Status JournalFile::finish(sqlite3_stmt* statement) {
  const int code = sqlite3_step(statement);
  const Status status = code == SQLITE_DONE ? Status(Done{}) : Status(problem("a record cannot be written"));
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
  return status;
}

Status JournalFile::insert(const std::string& run, const JournalRecord& record) {
  bind_text(insert_.get(), 1, run);
  bind_text(insert_.get(), 2, kind_of(record));
  bind_bytes(insert_.get(), 3, encode_record(record));
  return finish(insert_.get());
}

Status JournalFile::drop_records(const std::string& run) {
  bind_text(drop_run_.get(), 1, run);
  return finish(drop_run_.get());
}

Status JournalFile::put_into_archive(const JournalRecord& record, const JournalArchive& is) {
  auto put = compile(
      "INSERT OR REPLACE INTO archive(run, state, until, final, summary, record, submitter) VALUES(?, ?, ?, ?, ?, ?, "
      "?)");
  if (!put) return put.error();
  const Bytes end = is.end.kind.empty() ? Bytes() : encode(is.end);
  const Bytes summary = encode(RunChanged{summary_of(is.view)});
  const Bytes whole = encode_record(record);
  bind_text(put->get(), 1, is.view.run);
  sqlite3_bind_int64(put->get(), 2, static_cast<std::int64_t>(is.view.state));
  sqlite3_bind_int64(put->get(), 3, is.until);
  bind_bytes(put->get(), 4, end);
  bind_bytes(put->get(), 5, summary);
  bind_bytes(put->get(), 6, whole);
  bind_text(put->get(), 7, is.view.submitter);
  if (auto written = finish(put->get()); !written) return written;
  archived_ += static_cast<std::int64_t>(whole.size());
  sizes_[is.view.submitter] += static_cast<std::int64_t>(whole.size());
  return make_room();
}

/// Removes the oldest records of whoever has the most, so that nobody pushes out the others'; what is known of their
/// runs without a record stays.
Status JournalFile::make_room() {
  if (archived_ <= archive_bytes_) return Done{};
  auto find = compile(
      "SELECT seq, LENGTH(record) FROM archive WHERE record IS NOT NULL AND submitter = ? ORDER BY seq LIMIT 1");
  if (!find) return find.error();
  auto drop = compile("UPDATE archive SET record = NULL, summary = NULL WHERE seq = ?");
  if (!drop) return drop.error();
  while (archived_ > archive_bytes_) {
    const auto most = std::ranges::max_element(sizes_, {}, [](const auto& one) { return one.second; });
    bind_text(find->get(), 1, most->first);
    if (sqlite3_step(find->get()) != SQLITE_ROW) return damaged("its archive is not what it was");
    const std::int64_t size = sqlite3_column_int64(find->get(), 1);
    sqlite3_bind_int64(drop->get(), 1, sqlite3_column_int64(find->get(), 0));
    sqlite3_reset(find->get());
    if (auto dropped = finish(drop->get()); !dropped) return dropped;
    archived_ -= size;
    most->second -= size;
    if (most->second == 0) sizes_.erase(most);
  }
  return Done{};
}

Status JournalFile::write_all(const std::vector<Journal>& records) {
  for (const Journal& journal : records) {
    const auto record = to_journal_record(journal.record);
    if (!record) return record.error();
    const auto run_id = run_of(*record);
    if (!run_id) return run_id.error();
    if (const auto* over = std::get_if<JournalArchive>(&*record)) {
      if (auto dropped = drop_records(*run_id); !dropped) return dropped;
      if (auto put = put_into_archive(*record, *over); !put) return put;
      continue;
    }
    if (const auto* time = std::get_if<JournalTime>(&*record)) {
      if (auto dropped = run("DELETE FROM records WHERE kind = 'journal_time'"); !dropped) return dropped;
      if (auto pruned = prune({time->steady}); !pruned) return pruned;
    }
    if (std::holds_alternative<JournalLost>(*record)) {
      if (auto dropped = run("DELETE FROM records WHERE kind = 'journal_lost'"); !dropped) return dropped;
    }
    if (auto written = insert(*run_id, *record); !written) return written;
  }
  return run("COMMIT");
}

Status JournalFile::commit(const std::vector<Journal>& records) {
  if (records.empty()) return Done{};
  if (auto begun = run("BEGIN IMMEDIATE"); !begun) return begun;
  Status written = write_all(records);
  if (written) return written;
  sqlite3_exec(db_, "ROLLBACK", nullptr, nullptr, nullptr);
  (void)read_sizes();
  return written;
}

Result<JournalRecord> JournalFile::read_record(sqlite3_stmt* statement) const {
  const std::string name = "record " + std::to_string(sqlite3_column_int64(statement, 0)) + ": ";
  auto record = decode_record(column(statement, 1), column(statement, 2));
  if (!record) return damaged(name + record.error().what);
  const bool is_old = std::holds_alternative<JournalTombstone>(*record);
  if (auto run_id = is_old ? Result<std::string>(std::string()) : run_of(*record); !run_id) {
    return damaged(name + run_id.error().what);
  }
  return record;
}

Result<std::vector<JournalRecord>> JournalFile::load() {
  auto statement = compile("SELECT seq, kind, body FROM records ORDER BY seq");
  if (!statement) return statement.error();
  std::vector<JournalRecord> out;
  int code = SQLITE_OK;
  while ((code = sqlite3_step(statement->get())) == SQLITE_ROW) {
    auto record = read_record(statement->get());
    if (!record) return record.error();
    out.push_back(std::move(*record));
  }
  if (code != SQLITE_DONE) return damaged(sqlite3_errmsg(db_));
  return out;
}

Status JournalFile::prune(UtcTime steady) {
  auto statement = compile("DELETE FROM archive WHERE record IS NULL AND until <= ?");
  if (!statement) return statement.error();
  sqlite3_bind_int64(statement->get(), 1, steady.ns);
  return finish(statement->get());
}

Status JournalFile::has_room(const std::string& submitter) const {
  const std::string folder = std::filesystem::path(path_).parent_path();
  const auto disk = disk_state(folder);
  if (auto more = disk ? takes_more(*disk, folder) : Status(Done{}); !more) return more;
  auto count = compile("SELECT COUNT(*) FROM (SELECT 1 FROM archive WHERE record IS NULL AND submitter = ?1 LIMIT ?2)");
  if (!count) return Done{};
  bind_text(count->get(), 1, submitter);
  sqlite3_bind_int64(count->get(), 2, kMostWithoutRecord);
  const bool full =
      sqlite3_step(count->get()) == SQLITE_ROW && sqlite3_column_int64(count->get(), 0) >= kMostWithoutRecord;
  if (!full) return Done{};
  return fail(Errc::queue_full,
              "'" + submitter + "' has " + std::to_string(kMostWithoutRecord) +
                  " runs here that are over before their time, and whose records have made room",
              "give its runs a shorter life: --expires-h, or this node more room: archive_mb in node.json");
}

std::optional<Over> JournalFile::over(const std::string& run) const {
  // Whoever took it for a run that is not over would begin its tasks a second time.
  const auto unreadable = [&] {
    const std::string why = problem("whether run " + run + " is over cannot be read").text();
    log_event(Level::error, "journal_failed", why + " (the process ends: nothing may rest on it)");
    return std::runtime_error(why);
  };
  auto statement = compile("SELECT state, final FROM archive WHERE run = ?");
  if (!statement) throw unreadable();
  bind_text(statement->get(), 1, run);
  const int code = sqlite3_step(statement->get());
  if (code == SQLITE_DONE) return std::nullopt;
  if (code != SQLITE_ROW) throw unreadable();
  Over out;
  out.state = static_cast<RunState>(sqlite3_column_int(statement->get(), 0));
  const std::string end = column(statement->get(), 1);
  if (auto record = decode<SignedRecord>(end); record && !end.empty()) out.end = std::move(*record);
  return out;
}

Result<JournalArchive> JournalFile::record(const std::string& run) const {
  auto statement = compile("SELECT record FROM archive WHERE run = ? AND record IS NOT NULL");
  if (!statement) return statement.error();
  bind_text(statement->get(), 1, run);
  const int code = sqlite3_step(statement->get());
  if (code == SQLITE_DONE) return fail(Errc::missing, path_ + ": no record of run " + run);
  if (code != SQLITE_ROW) return problem("the record of run " + run + " cannot be read");
  auto record = decode_record(JournalArchive::kKind, column(statement->get(), 0));
  if (record) return std::move(std::get<JournalArchive>(*record));
  return fail(Errc::io_error, path_ + ": the record of run " + run + " is damaged: " + record.error().what,
              "check the disk; the other nodes of the run have records of their own");
}

std::vector<std::string> JournalFile::ids(const std::string& beginning, std::size_t most) const {
  // An id is hexadecimal: no id with this beginning sorts after "g".
  auto statement = compile("SELECT run FROM archive WHERE run >= ? AND run < ? ORDER BY seq DESC LIMIT ?");
  std::vector<std::string> out;
  if (!statement) return out;
  bind_text(statement->get(), 1, beginning);
  bind_text(statement->get(), 2, beginning + "g");
  sqlite3_bind_int64(statement->get(), 3, static_cast<std::int64_t>(most));
  while (sqlite3_step(statement->get()) == SQLITE_ROW) out.push_back(column(statement->get(), 0));
  return out;
}

ArchivePage JournalFile::page(const std::string& after, std::size_t most) const {
  auto statement = compile(
      "SELECT summary FROM archive WHERE summary IS NOT NULL AND (?1 = '' OR seq < (SELECT seq FROM archive WHERE run "
      "= "
      "?1)) ORDER BY seq DESC LIMIT ?2");
  ArchivePage out;
  if (!statement) return out;
  bind_text(statement->get(), 1, after);
  sqlite3_bind_int64(statement->get(), 2, static_cast<std::int64_t>(most) + 1);
  while (sqlite3_step(statement->get()) == SQLITE_ROW) {
    auto row = decode<RunChanged>(column(statement->get(), 0));
    if (out.runs.size() == most) {
      out.more = true;
    } else if (row) {
      out.runs.push_back(std::move(row->run));
    }
  }
  return out;
}

Error JournalFile::problem(const std::string& what) const {
  return fail(Errc::io_error, path_ + ": " + what + ": " + sqlite3_errmsg(db_),
              "check the disk's space and the file's rights");
}

Error JournalFile::damaged(const std::string& what) const {
  return fail(Errc::malformed, path_ + ": damaged: " + what,
              "move it away together with its -wal and -shm files and start again; this node then knows nothing of its "
              "open runs, and begins nothing before somebody has looked at the robot: trb robot repaired");
}

}  // namespace trb::scheduler
