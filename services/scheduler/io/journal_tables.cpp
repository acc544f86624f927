#include "services/scheduler/io/journal_tables.hpp"

#include <vector>

namespace trb::scheduler {
namespace {

constexpr std::size_t kNamedAtOnce = 100;  ///< rows of an earlier version in a transaction
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

Result<std::int64_t> number(SqliteFile& file, const char* sql) {
  std::int64_t out = 0;
  const Status read = file.rows(sql, [&](const Columns& row) -> Status {
    out = row.integer(0);
    return Done{};
  });
  if (!read) return read.error();
  return out;
}

/// Version 1 kept the runs that are over as tombstone records, and nothing else of them.
Status move_tombstones(SqliteFile& file) {
  const auto move = [&](const Columns& row) -> Status {
    const auto record = read_journal_row(file, row);
    if (!record) return record.error();
    const auto& is = std::get<JournalTombstone>(*record);
    return file.run("INSERT OR REPLACE INTO archive(run, state, until) VALUES(?, ?, ?)", is.run,
                    static_cast<std::int64_t>(is.state), is.until);
  };
  const Status moved =
      file.rows("SELECT seq, kind, body FROM records WHERE kind = 'journal_tombstone' ORDER BY seq", move);
  return moved ? file.run("DELETE FROM records WHERE kind = 'journal_tombstone'") : moved;
}

/// An earlier version does not know the column, reads the file all the same, and writes rows without it.
Status add_submitters(SqliteFile& file) {
  const auto known = number(file, "SELECT COUNT(*) FROM pragma_table_info('archive') WHERE name = 'submitter'");
  if (!known) return known.error();
  if (*known == 0) {
    if (auto added = file.script("ALTER TABLE archive ADD COLUMN submitter TEXT"); !added) return added;
  }
  return file.script(kSubmitterIndexes);
}

/// Names the submitter of some rows; `named`: of how many.
Status name_some(SqliteFile& file, std::size_t& named) {
  std::vector<std::int64_t> rows;
  const auto remember = [&](const Columns& row) -> Status {
    rows.push_back(row.integer(0));
    return Done{};
  };
  const Status found = file.rows("SELECT seq FROM archive WHERE record IS NOT NULL AND submitter IS NULL LIMIT ?",
                                 remember, static_cast<std::int64_t>(kNamedAtOnce));
  if (!found) return found;
  for (const std::int64_t row : rows) {
    std::string submitter;  // a damaged record is nobody's
    const auto learn = [&](const Columns& columns) -> Status {
      const auto record = decode_record(JournalArchive::kKind, columns.text(0));
      if (const auto* is = record ? std::get_if<JournalArchive>(&*record) : nullptr) submitter = is->view.submitter;
      return Done{};
    };
    if (auto read = file.rows("SELECT record FROM archive WHERE seq = ?", learn, row); !read) return read;
    if (auto put = file.run("UPDATE archive SET submitter = ? WHERE seq = ?", submitter, row); !put) return put;
  }
  named = rows.size();
  return Done{};
}

/// To name a row's submitter moves its record: few rows a transaction, so that no disk needs room for all at once.
Status name_submitters(SqliteFile& file) {
  for (std::size_t named = kNamedAtOnce; named == kNamedAtOnce;) {
    if (auto some = file.transact([&] { return name_some(file, named); }); !some) return some;
  }
  return Done{};
}

Status make_tables(SqliteFile& file, std::int64_t version, bool lost) {
  Status made = file.script(kTables);
  // In one transaction with the tables: a crash in between is not taken for a first start.
  if (made && lost) made = insert_journal_row(file, "", JournalLost{});
  if (made && version == 1) made = move_tombstones(file);
  if (made) made = add_submitters(file);
  return made ? file.script(("PRAGMA user_version=" + std::to_string(kJournalVersion)).c_str()) : made;
}

}  // namespace

Result<bool> bring_journal_up_to_date(SqliteFile& file, bool known) {
  const auto version = number(file, "PRAGMA user_version");
  if (!version) return version.error();
  if (*version > kJournalVersion) {
    return fail(Errc::version_mismatch,
                file.path() + ": schema version " + std::to_string(*version) + ", this build knows " +
                    std::to_string(kJournalVersion),
                "start the build that wrote it, or move the file away once its runs are over");
  }
  const bool lost = *version == 0 && known;
  if (auto made = file.transact([&] { return make_tables(file, *version, lost); }); !made) return made.error();
  if (auto named = name_submitters(file); !named) return named.error();
  return lost;
}

Result<JournalRecord> read_journal_row(const SqliteFile& file, const Columns& row) {
  const std::string name = "record " + std::to_string(row.integer(0)) + ": ";
  auto record = decode_record(row.text(1), row.text(2));
  if (!record) return file.damaged(name + record.error().what);
  const bool is_old = std::holds_alternative<JournalTombstone>(*record);
  if (auto run = is_old ? Result<std::string>(std::string()) : run_of(*record); !run) {
    return file.damaged(name + run.error().what);
  }
  return record;
}

Status insert_journal_row(SqliteFile& file, const std::string& run, const JournalRecord& record) {
  const Bytes body = encode_record(record);
  return file.run("INSERT INTO records(run, kind, body) VALUES(?, ?, ?)", run, kind_of(record), BlobView{body});
}

}  // namespace trb::scheduler
