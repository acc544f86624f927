// The tables of the scheduler's journal, and how a file of an earlier version gets them.
#pragma once

#include "common/sqlite/sqlite_file.hpp"
#include "services/scheduler/core/journal_records.hpp"

namespace trb::scheduler {

inline constexpr std::int64_t kJournalVersion = 2;

/// Makes the tables of a new file, and those of an earlier version this one's. `known`: there was a file before; if
/// this one is new, that is recorded in it (JournalLost). Returns whether it was. Errors: version_mismatch (a later
/// version has written it), those of SqliteFile.
Result<bool> bring_journal_up_to_date(SqliteFile& file, bool known);

/// The record of a row (seq, kind, body). Error: malformed; it names the record and the file's cure.
Result<JournalRecord> read_journal_row(const SqliteFile& file, const Columns& row);

/// Adds a record of a run; of none if `run` is empty. Errors: those of SqliteFile.
Status insert_journal_row(SqliteFile& file, const std::string& run, const JournalRecord& record);

}  // namespace trb::scheduler
