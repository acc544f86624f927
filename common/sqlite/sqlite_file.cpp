#include "common/sqlite/sqlite_file.hpp"

#include <sqlite3.h>

namespace trb {
namespace {

constexpr int kBusyMs = 1000;

std::string hint_for(int code) {
  if (code == SQLITE_CONSTRAINT) return "read what is there, and decide anew";
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED) return "another process writes to it: end that one, or try again";
  return "check the disk's space and the file's rights";
}

}  // namespace

std::string Columns::text(int column) const {
  const void* bytes = sqlite3_column_blob(statement_, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
}

std::int64_t Columns::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

double Columns::real(int column) const {
  return sqlite3_column_double(statement_, column);
}

bool Columns::is_null(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

Result<std::unique_ptr<SqliteFile>> SqliteFile::open(const std::string& path, std::string hint, Index index) {
  sqlite3* db = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  std::unique_ptr<SqliteFile> file(new SqliteFile(path, std::move(hint), db));
  if (code != SQLITE_OK) return file->problem("cannot be opened");
  sqlite3_busy_timeout(db, kBusyMs);
  if (index == Index::within) {
    if (Status alone = file->script("PRAGMA locking_mode=EXCLUSIVE"); !alone) return alone.error();
  }
  const Status ready = file->script("PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL; PRAGMA foreign_keys=ON");
  if (!ready) return ready.error();
  return file;
}

SqliteFile::~SqliteFile() {
  statements_.clear();
  sqlite3_close_v2(db_);
}

Status SqliteFile::keep_side_files() {
  int is_kept = 1;
  sqlite3_file_control(db_, "main", SQLITE_FCNTL_PERSIST_WAL, &is_kept);
  return script("PRAGMA journal_size_limit=4194304");
}

Status SqliteFile::script(const char* sql) {
  if (sqlite3_exec(db_, sql, nullptr, nullptr, nullptr) == SQLITE_OK) return Done{};
  return problem("cannot be set up");
}

Result<sqlite3_stmt*> SqliteFile::prepared(const char* sql) {
  const auto at = statements_.find(std::string_view(sql));
  if (at != statements_.end()) return at->second.get();
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(db_, sql, -1, &statement, nullptr) != SQLITE_OK) return problem(sql);
  statements_.emplace(sql, Statement(statement, sqlite3_finalize));
  return statement;
}

Status SqliteFile::step(sqlite3_stmt* statement, const EachRow& each) {
  Status status = Done{};
  int code = SQLITE_OK;
  while (status && (code = sqlite3_step(statement)) == SQLITE_ROW) {
    if (each) status = each(Columns(statement));
  }
  if (status && code != SQLITE_DONE) status = problem(sqlite3_sql(statement));
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
  return status;
}

Status SqliteFile::transact(const std::function<Status()>& work) {
  if (in_transaction_) return work();
  if (auto begun = run("BEGIN IMMEDIATE"); !begun) return begun;
  in_transaction_ = true;
  Status done = work();
  if (done) done = run("COMMIT");
  if (!done) sqlite3_exec(db_, "ROLLBACK", nullptr, nullptr, nullptr);
  in_transaction_ = false;
  return done;
}

int SqliteFile::changed() const {
  return sqlite3_changes(db_);
}

void SqliteFile::bind(sqlite3_stmt* statement, int place, std::string_view text) {
  // An empty view may hold a null pointer, which SQLite would bind as NULL.
  sqlite3_bind_text(statement, place, text.empty() ? "" : text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

void SqliteFile::bind(sqlite3_stmt* statement, int place, BlobView blob) {
  const std::string_view bytes = blob.bytes;
  sqlite3_bind_blob(statement, place, bytes.empty() ? "" : bytes.data(), static_cast<int>(bytes.size()),
                    SQLITE_TRANSIENT);
}

void SqliteFile::bind(sqlite3_stmt* statement, int place, std::int64_t number) {
  sqlite3_bind_int64(statement, place, number);
}

void SqliteFile::bind(sqlite3_stmt* statement, int place, double number) {
  sqlite3_bind_double(statement, place, number);
}

Error SqliteFile::problem(const std::string& what) const {
  const int code = sqlite3_errcode(db_);
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT) return damaged(sqlite3_errmsg(db_));
  const Errc kind = code == SQLITE_CONSTRAINT ? Errc::conflict : Errc::io_error;
  return fail(kind, path_ + ": " + what + ": " + sqlite3_errmsg(db_), hint_for(code));
}

Error SqliteFile::damaged(const std::string& what) const {
  return fail(Errc::malformed, path_ + ": damaged: " + what, hint_);
}

}  // namespace trb
