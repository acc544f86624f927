// The scheduler's journal: one SQLite file, written before anything is said of what it records.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/actor/outbox.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace trb::scheduler {

class JournalFile {
 public:
  static constexpr int kSchemaVersion = 1;

  /// Opens or makes the file (WAL, synchronous=FULL). Errors: io_error, malformed (no database, a damaged one),
  /// version_mismatch; each names the file and the cure.
  static Result<std::unique_ptr<JournalFile>> open(const std::string& path);

  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;
  ~JournalFile();

  /// Writes the records of one step in one transaction; a tombstone drops its run's older records in the same one.
  /// Errors: io_error, bad_value (not a journal record); then nothing of the step is written.
  Status commit(const std::vector<Journal>& records);

  /// Every record in the order of writing. Errors: malformed, io_error.
  Result<std::vector<Body>> load();

  /// Drops tombstones whose time has come; done at the start. Errors: malformed, io_error.
  Status prune(UtcTime now);

 private:
  struct Row {
    std::int64_t sequence = 0;
    Body record;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

  JournalFile(std::string path, sqlite3* db) : path_(std::move(path)), db_(db) {}
  Status prepare();
  Status check_version();
  Result<int> user_version();
  Status run(const char* sql);
  Result<Statement> compile(const char* sql);
  Status insert(const std::string& run, const Body& record);
  Status drop_run(const std::string& run);
  Status drop_row(std::int64_t sequence);
  Status finish(sqlite3_stmt* statement);
  Status write_all(const std::vector<Journal>& records);
  Result<std::vector<Row>> rows();
  Result<Row> read_row(sqlite3_stmt* statement) const;
  [[nodiscard]] Error problem(const std::string& what) const;
  [[nodiscard]] Error damaged(const std::string& what) const;

  std::string path_;
  sqlite3* db_ = nullptr;
  Statement insert_{nullptr, nullptr};
  Statement drop_run_{nullptr, nullptr};
  Statement drop_row_{nullptr, nullptr};
};

/// The run that a journal record belongs to. Errors: bad_value (no journal record), malformed.
Result<std::string> run_of(const Body& record);

}  // namespace trb::scheduler
