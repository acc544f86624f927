// What everybody has signed of a run, as this node knows it.
#pragma once

#include <vector>

#include "services/scheduler/core/journal_records.hpp"
#include "services/scheduler/core/run/run.hpp"

namespace trb::scheduler {

/// Fills in every record of a run; not its view, and not how long it is kept.
void put_signed_records(const Run& run, JournalArchive& into);

/// In the order of RunRecords. Empty: the start is not there (JournalArchive::start).
std::vector<SignedRecord> signed_records_of(const JournalArchive& fact);

/// The page from record `first` on: as many as fit a message, one at least; none behind the last.
RunRecords page_of(const std::vector<SignedRecord>& all, std::uint32_t first);

}  // namespace trb::scheduler
