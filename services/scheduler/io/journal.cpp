#include "services/scheduler/io/journal.hpp"

#include <filesystem>
#include <stdexcept>

#include "common/base/bytes.hpp"
#include "common/base/disk_state.hpp"
#include "common/base/files.hpp"
#include "common/log/log.hpp"
#include "services/scheduler/core/view.hpp"
#include "services/scheduler/io/journal_tables.hpp"

namespace trb::scheduler {
namespace {

constexpr const char* kKnown = ".known";
constexpr const char* kDamaged =
    "move it away together with its -wal and -shm files and start again; this node then knows nothing of its open "
    "runs, "
    "and begins nothing before somebody has looked at the robot: trb robot repaired";

}  // namespace

Result<std::unique_ptr<JournalFile>> JournalFile::open(const std::string& path, std::int64_t archive_bytes) {
  auto file = SqliteFile::open(path, kDamaged);
  if (!file) return file.error();
  const bool known = file_exists(path + kKnown);
  const auto lost = bring_journal_up_to_date(**file, known);
  if (!lost) return lost.error();
  std::unique_ptr<JournalFile> journal(new JournalFile(std::move(*file), archive_bytes, *lost));
  if (auto counted = journal->room_.read(*journal->file_); !counted) return counted.error();
  if (known) return journal;
  const Status noted =
      write_file(path + kKnown, "Without this file a missing journal.db beside it counts as a first start.\n");
  if (!noted) return noted.error();
  return journal;
}

Status JournalFile::drop_records(const std::string& run) {
  return file_->run("DELETE FROM records WHERE run = ?", run);
}

Status JournalFile::put_into_archive(const JournalRecord& record, const JournalArchive& is) {
  const Bytes end = is.end.kind.empty() ? Bytes() : encode(is.end);
  const Bytes summary = encode(RunChanged{summary_of(is.view)});
  const Bytes whole = encode_record(record);
  const Status put = file_->run(
      "INSERT OR REPLACE INTO archive(run, state, until, final, summary, record, submitter) VALUES(?, ?, ?, ?, ?, ?, "
      "?)",
      is.view.run, static_cast<std::int64_t>(is.view.state), is.until, BlobView{end}, BlobView{summary},
      BlobView{whole}, is.view.submitter);
  if (!put) return put;
  room_.add(is.view.submitter, whole.size());
  return room_.make(*file_);
}

Status JournalFile::write(const Journal& journal) {
  const auto record = to_journal_record(journal.record);
  if (!record) return record.error();
  const auto run = run_of(*record);
  if (!run) return run.error();
  if (const auto* over = std::get_if<JournalArchive>(&*record)) {
    const Status dropped = drop_records(*run);
    return dropped ? put_into_archive(*record, *over) : dropped;
  }
  if (const auto* time = std::get_if<JournalTime>(&*record)) {
    if (auto dropped = file_->run("DELETE FROM records WHERE kind = 'journal_time'"); !dropped) return dropped;
    if (auto pruned = prune({time->steady}); !pruned) return pruned;
  }
  if (std::holds_alternative<JournalLost>(*record)) {
    if (auto dropped = file_->run("DELETE FROM records WHERE kind = 'journal_lost'"); !dropped) return dropped;
  }
  return insert_journal_row(*file_, *run, *record);
}

Status JournalFile::commit(const std::vector<Journal>& records) {
  if (records.empty()) return Done{};
  Status written = file_->transact([&]() -> Status {
    for (const Journal& journal : records) {
      if (auto done = write(journal); !done) return done;
    }
    return Done{};
  });
  if (!written) (void)room_.read(*file_);  // it was rolled back
  return written;
}

Result<std::vector<JournalRecord>> JournalFile::load() {
  std::vector<JournalRecord> out;
  const auto keep = [&](const Columns& row) -> Status {
    auto record = read_journal_row(*file_, row);
    if (!record) return record.error();
    out.push_back(std::move(*record));
    return Done{};
  };
  const Status read = file_->rows("SELECT seq, kind, body FROM records ORDER BY seq", keep);
  if (!read) return read.error();
  return out;
}

Status JournalFile::prune(UtcTime steady) {
  return file_->run("DELETE FROM archive WHERE record IS NULL AND until <= ?", steady.ns);
}

Status JournalFile::has_room(const std::string& submitter) const {
  const std::string folder = std::filesystem::path(file_->path()).parent_path();
  const auto disk = disk_state(folder);
  if (auto more = disk ? takes_more(*disk, folder) : Status(Done{}); !more) return more;
  std::int64_t count = 0;
  (void)file_->rows(
      "SELECT COUNT(*) FROM (SELECT 1 FROM archive WHERE record IS NULL AND submitter = ?1 LIMIT ?2)",
      [&](const Columns& row) -> Status {
        count = row.integer(0);
        return Done{};
      },
      submitter, kMostWithoutRecord);
  if (count < kMostWithoutRecord) return Done{};
  return fail(Errc::queue_full,
              "'" + submitter + "' has " + std::to_string(kMostWithoutRecord) +
                  " runs here that are over before their time, and whose records have made room",
              "give its runs a shorter life: --expires-h, or this node more room: archive_mb in node.json");
}

std::optional<Over> JournalFile::over(const std::string& run) const {
  std::optional<Over> out;
  const auto take = [&](const Columns& row) -> Status {
    out.emplace().state = static_cast<RunState>(row.integer(0));
    const std::string end = row.text(1);
    if (auto record = decode<SignedRecord>(end); record && !end.empty()) out->end = std::move(*record);
    return Done{};
  };
  const Status read = file_->rows("SELECT state, final FROM archive WHERE run = ?", take, run);
  if (read) return out;
  // Whoever took it for a run that is not over would begin its tasks a second time.
  const std::string why = file_->path() + ": whether run " + run + " is over cannot be read: " + read.error().text();
  log_event(Level::error, "journal_failed", why + " (the process ends: nothing may rest on it)");
  throw std::runtime_error(why);
}

Result<JournalArchive> JournalFile::record(const std::string& run) const {
  Result<JournalArchive> out = fail(Errc::missing, file_->path() + ": no record of run " + run);
  const auto take = [&](const Columns& row) -> Status {
    auto record = decode_record(JournalArchive::kKind, row.text(0));
    if (record) {
      out = std::move(std::get<JournalArchive>(*record));
    } else {
      out = fail(Errc::io_error, file_->path() + ": the record of run " + run + " is damaged: " + record.error().what,
                 "check the disk; the other nodes of the run have records of their own");
    }
    return Done{};
  };
  const Status read = file_->rows("SELECT record FROM archive WHERE run = ? AND record IS NOT NULL", take, run);
  return read ? out : Result<JournalArchive>(read.error());
}

std::vector<std::string> JournalFile::ids(const std::string& beginning, std::size_t most) const {
  std::vector<std::string> out;
  // An id is hexadecimal: no id with this beginning sorts after "g".
  (void)file_->rows(
      "SELECT run FROM archive WHERE run >= ? AND run < ? ORDER BY seq DESC LIMIT ?",
      [&](const Columns& row) -> Status {
        out.push_back(row.text(0));
        return Done{};
      },
      beginning, beginning + "g", static_cast<std::int64_t>(most));
  return out;
}

ArchivePage JournalFile::page(const std::string& after, std::size_t most) const {
  ArchivePage out;
  std::size_t rows = 0;
  (void)file_->rows(
      "SELECT summary FROM archive WHERE summary IS NOT NULL AND (?1 = '' OR seq < (SELECT seq FROM archive WHERE run "
      "= ?1)) ORDER BY seq DESC LIMIT ?2",
      [&](const Columns& row) -> Status {
        out.more = ++rows > most;
        auto summary = decode<RunChanged>(row.text(0));
        if (summary && !out.more) out.runs.push_back(std::move(summary->run));
        return Done{};
      },
      after, static_cast<std::int64_t>(most) + 1);
  return out;
}

}  // namespace trb::scheduler
