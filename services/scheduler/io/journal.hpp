// The scheduler's journal: one SQLite file, written before anything based on it is sent. It also holds the archive: the
// runs that are over.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/actor/outbox.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "services/scheduler/core/archive.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace trb::scheduler {

class JournalFile final : public Archive {
 public:
  static constexpr int kSchemaVersion = 2;

  /// So many runs of one submitter may be known to be over without a record, until their time has come.
  static constexpr std::int64_t kMostWithoutRecord = 16'384;

  /// Opens or creates the file (WAL, synchronous=FULL); an older schema is brought up to date. `archive_bytes`: when
  /// the records of the archive take more, the oldest of the submitter that has the most are removed; that those runs
  /// are over stays known as long as messages for them may come. Errors: io_error, malformed (not a database, or
  /// damaged), version_mismatch; each names the file and a cure.
  static Result<std::unique_ptr<JournalFile>> open(const std::string& path, std::int64_t archive_bytes);

  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;
  ~JournalFile() override;

  /// The file is new, though one existed before (PATH.known exists): the old one's contents are lost, and the new one
  /// records that (JournalLost).
  [[nodiscard]] bool was_lost() const { return lost_; }

  /// Writes the records of one step in one transaction; JournalArchive replaces its run's records, JournalTime and
  /// JournalLost replace the previous one. Errors: io_error, bad_value (not a journal record); then nothing of the step
  /// is written.
  Status commit(const std::vector<Journal>& records);

  /// Every record in the order of writing, without the archive. Errors: malformed, io_error.
  Result<std::vector<JournalRecord>> load();

  /// Removes runs of the archive that have no record and for which no message can come any more; called with each
  /// JournalTime. Error: io_error.
  Status prune(UtcTime steady);

  // Of ids() and page() what cannot be read is left out; open() and load() report damage.
  [[nodiscard]] Status has_room(const std::string& submitter) const override;
  /// Throws std::runtime_error if it cannot be read: it ends the process, as a failed commit does.
  [[nodiscard]] std::optional<Over> over(const std::string& run) const override;
  [[nodiscard]] Result<JournalArchive> record(const std::string& run) const override;
  [[nodiscard]] std::vector<std::string> ids(const std::string& beginning, std::size_t most) const override;
  [[nodiscard]] ArchivePage page(const std::string& after, std::size_t most) const override;

 private:
  using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

  JournalFile(std::string path, sqlite3* db, std::int64_t archive_bytes)
      : path_(std::move(path)), db_(db), archive_bytes_(archive_bytes) {}
  Status prepare();
  Status bring_up_to_date();
  Status move_tombstones();
  Status add_submitters();
  Status name_submitters();
  Result<std::size_t> name_some();
  Status read_sizes();
  Status note_lost();
  Result<std::int64_t> number(const char* sql);
  Status run(const char* sql);
  Result<Statement> compile(const char* sql) const;
  Status insert(const std::string& run, const JournalRecord& record);
  Status drop_records(const std::string& run);
  Status put_into_archive(const JournalRecord& record, const JournalArchive& is);
  Status make_room();
  Status finish(sqlite3_stmt* statement);
  Status write_all(const std::vector<Journal>& records);
  Status note_known();
  Result<JournalRecord> read_record(sqlite3_stmt* statement) const;
  [[nodiscard]] Error problem(const std::string& what) const;
  [[nodiscard]] Error damaged(const std::string& what) const;

  std::string path_;
  sqlite3* db_ = nullptr;
  std::int64_t archive_bytes_ = 0;
  std::int64_t archived_ = 0;                    ///< bytes of the archive's records
  std::map<std::string, std::int64_t> sizes_{};  ///< the same by submitter
  bool lost_ = false;
  Statement insert_{nullptr, nullptr};
  Statement drop_run_{nullptr, nullptr};
};

}  // namespace trb::scheduler
