// The scheduler's journal: one SQLite file, written before anything based on it is sent. It also holds the archive: the
// runs that are over.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/actor/outbox.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "common/sqlite/sqlite_file.hpp"
#include "services/scheduler/core/archive.hpp"
#include "services/scheduler/io/archive_room.hpp"

namespace trb::scheduler {

class JournalFile final : public Archive {
 public:
  /// So many runs of one submitter may be known to be over without a record, until their time has come.
  static constexpr std::int64_t kMostWithoutRecord = 16'384;

  /// Opens or creates the file; an older schema is brought up to date. `archive_bytes`: when
  /// the records of the archive take more, the oldest of the submitter that has the most are removed; that those runs
  /// are over stays known as long as messages for them may come. Errors: io_error, malformed (not a database, or
  /// damaged), version_mismatch; each names the file and a cure.
  static Result<std::unique_ptr<JournalFile>> open(const std::string& path, std::int64_t archive_bytes);

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
  JournalFile(std::unique_ptr<SqliteFile> file, std::int64_t archive_bytes, bool lost)
      : file_(std::move(file)), room_(archive_bytes), lost_(lost) {}
  Status write(const Journal& journal);
  Status drop_records(const std::string& run);
  Status put_into_archive(const JournalRecord& record, const JournalArchive& is);

  std::unique_ptr<SqliteFile> file_;
  ArchiveRoom room_;
  bool lost_ = false;
};

}  // namespace trb::scheduler
