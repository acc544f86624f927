#include "services/scheduler/io/journal.hpp"

#include <sqlite3.h>

#include "common/base/bytes.hpp"

namespace trb::scheduler {
namespace {

constexpr const char* kTable =
    "CREATE TABLE IF NOT EXISTS records("
    "seq INTEGER PRIMARY KEY AUTOINCREMENT, run TEXT NOT NULL, kind TEXT NOT NULL, body BLOB NOT NULL);"
    "CREATE INDEX IF NOT EXISTS records_of_run ON records(run);";

template <class Payload>
Result<std::string> run_in(const SignedRecord& record, std::string (*run)(const Payload&)) {
  const auto payload = decode<Payload>(record.payload.bytes);
  if (!payload) return payload.error();
  return run(*payload);
}

void bind_text(sqlite3_stmt* statement, int place, std::string_view text) {
  sqlite3_bind_text(statement, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

std::string column(sqlite3_stmt* statement, int place) {
  const void* bytes = sqlite3_column_blob(statement, place);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, place));
  return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
}

}  // namespace

Result<std::string> run_of(const Body& record) {
  using Run = Result<std::string>;
  return visit(Overloaded{
                   [](const JournalRun& is) -> Run {
                     return run_in<RunStart>(is.start, [](const RunStart& start) { return start.run; });
                   },
                   [](const JournalStart& is) -> Run { return is.key.run; },
                   [](const JournalResult& is) -> Run {
                     return run_in<TaskResult>(is.result, [](const TaskResult& result) { return result.key.run; });
                   },
                   [](const JournalChoice& is) -> Run {
                     return run_in<Choice>(is.choice, [](const Choice& choice) { return choice.run; });
                   },
                   [](const JournalDelivered& is) -> Run { return is.run; },
                   [](const JournalAbort& is) -> Run {
                     return run_in<AbortOrder>(is.order, [](const AbortOrder& order) { return order.run; });
                   },
                   [](const JournalDecision& is) -> Run {
                     return run_in<Decision>(is.decision, [](const Decision& one) { return one.run; });
                   },
                   [](const JournalPause& is) -> Run {
                     return run_in<PauseOrder>(is.order, [](const PauseOrder& order) { return order.run; });
                   },
                   [](const JournalTombstone& is) -> Run { return is.run; },
                   [](const auto& other) -> Run {
                     return fail(Errc::bad_value,
                                 "'" + std::string(subtype_of(Body(other))) + "' is no journal record");
                   },
               },
               record);
}

Result<std::unique_ptr<JournalFile>> JournalFile::open(const std::string& path) {
  sqlite3* db = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  std::unique_ptr<JournalFile> file(new JournalFile(path, db));
  if (code != SQLITE_OK) return file->problem("cannot be opened");
  if (auto ready = file->prepare(); !ready) return ready.error();
  return file;
}

JournalFile::~JournalFile() {
  insert_.reset();
  drop_run_.reset();
  drop_row_.reset();
  sqlite3_close_v2(db_);
}

Status JournalFile::prepare() {
  sqlite3_busy_timeout(db_, 1000);
  for (const char* sql : {"PRAGMA journal_mode=WAL", "PRAGMA synchronous=FULL"}) {
    if (auto set = run(sql); !set) return set;
  }
  if (auto version = check_version(); !version) return version;
  if (auto table = run(kTable); !table) return table;
  struct Wanted {
    Statement& statement;
    const char* sql;
  };
  const Wanted all[] = {{insert_, "INSERT INTO records(run, kind, body) VALUES(?, ?, ?)"},
                        {drop_run_, "DELETE FROM records WHERE run = ?"},
                        {drop_row_, "DELETE FROM records WHERE seq = ?"}};
  for (const Wanted& wanted : all) {
    auto compiled = compile(wanted.sql);
    if (!compiled) return compiled.error();
    wanted.statement = std::move(*compiled);
  }
  return Done{};
}

Status JournalFile::check_version() {
  const auto version = user_version();
  if (!version) return version.error();
  if (*version == kSchemaVersion) return Done{};
  if (*version == 0) return run(("PRAGMA user_version=" + std::to_string(kSchemaVersion)).c_str());
  return fail(
      Errc::version_mismatch,
      path_ + ": schema version " + std::to_string(*version) + ", this build knows " + std::to_string(kSchemaVersion),
      "start the build that wrote it, or move the file away once its runs are over");
}

Result<int> JournalFile::user_version() {
  auto statement = compile("PRAGMA user_version");
  if (!statement) return statement.error();
  if (sqlite3_step(statement->get()) != SQLITE_ROW) return damaged("its version cannot be read");
  return sqlite3_column_int(statement->get(), 0);
}

Status JournalFile::run(const char* sql) {
  const int code = sqlite3_exec(db_, sql, nullptr, nullptr, nullptr);
  if (code == SQLITE_OK) return Done{};
  return code == SQLITE_NOTADB || code == SQLITE_CORRUPT ? damaged(sqlite3_errmsg(db_)) : problem(sql);
}

Result<JournalFile::Statement> JournalFile::compile(const char* sql) {
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

Status JournalFile::insert(const std::string& run, const Body& record) {
  const Bytes body = encode_body(record);
  bind_text(insert_.get(), 1, run);
  bind_text(insert_.get(), 2, subtype_of(record));
  sqlite3_bind_blob(insert_.get(), 3, body.data(), static_cast<int>(body.size()), SQLITE_TRANSIENT);
  return finish(insert_.get());
}

Status JournalFile::drop_run(const std::string& run) {
  bind_text(drop_run_.get(), 1, run);
  return finish(drop_run_.get());
}

Status JournalFile::drop_row(std::int64_t sequence) {
  sqlite3_bind_int64(drop_row_.get(), 1, sequence);
  return finish(drop_row_.get());
}

Status JournalFile::write_all(const std::vector<Journal>& records) {
  for (const Journal& journal : records) {
    const auto run_id = run_of(journal.record);
    if (!run_id) return run_id.error();
    if (holds_alternative<JournalTombstone>(journal.record)) {
      if (auto dropped = drop_run(*run_id); !dropped) return dropped;
    }
    if (auto written = insert(*run_id, journal.record); !written) return written;
  }
  return run("COMMIT");
}

Status JournalFile::commit(const std::vector<Journal>& records) {
  if (records.empty()) return Done{};
  if (auto begun = run("BEGIN IMMEDIATE"); !begun) return begun;
  Status written = write_all(records);
  if (!written) sqlite3_exec(db_, "ROLLBACK", nullptr, nullptr, nullptr);
  return written;
}

Result<JournalFile::Row> JournalFile::read_row(sqlite3_stmt* statement) const {
  const std::int64_t sequence = sqlite3_column_int64(statement, 0);
  const std::string name = "record " + std::to_string(sequence) + ": ";
  auto record = decode_body(column(statement, 1), column(statement, 2));
  if (!record) return damaged(name + record.error().what);
  if (auto run_id = run_of(*record); !run_id) return damaged(name + run_id.error().what);
  return Row{sequence, std::move(*record)};
}

Result<std::vector<JournalFile::Row>> JournalFile::rows() {
  auto statement = compile("SELECT seq, kind, body FROM records ORDER BY seq");
  if (!statement) return statement.error();
  std::vector<Row> out;
  int code = SQLITE_OK;
  while ((code = sqlite3_step(statement->get())) == SQLITE_ROW) {
    auto row = read_row(statement->get());
    if (!row) return row.error();
    out.push_back(std::move(*row));
  }
  if (code != SQLITE_DONE) return damaged(sqlite3_errmsg(db_));
  return out;
}

Result<std::vector<Body>> JournalFile::load() {
  auto all = rows();
  if (!all) return all.error();
  std::vector<Body> out;
  for (Row& row : *all) out.push_back(std::move(row.record));
  return out;
}

Status JournalFile::prune(UtcTime now) {
  const auto all = rows();
  if (!all) return all.error();
  for (const Row& row : *all) {
    const auto* tombstone = get_if<JournalTombstone>(&row.record);
    if (tombstone == nullptr || tombstone->until > now.ns) continue;
    if (auto dropped = drop_row(row.sequence); !dropped) return dropped;
  }
  return Done{};
}

Error JournalFile::problem(const std::string& what) const {
  return fail(Errc::io_error, path_ + ": " + what + ": " + sqlite3_errmsg(db_),
              "check the disk's space and the file's rights");
}

Error JournalFile::damaged(const std::string& what) const {
  return fail(Errc::malformed, path_ + ": damaged: " + what,
              "move it away together with its -wal and -shm files and start again; this node then knows nothing of its "
              "open runs, so look at the robot and abort them first");
}

}  // namespace trb::scheduler
