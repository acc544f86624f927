// Which run a message or a journal record is about.
#pragma once

#include <string>

#include "common/base/result.hpp"
#include "services/scheduler/core/journal_records.hpp"

namespace trb::scheduler {

/// Of a message: its run's id, also inside a signed order or decision; empty: of none.
std::string named_run(const Body& body);

/// Of a journal record; empty: of the whole journal. Errors: bad_value (one that no journal has any more), malformed.
Result<std::string> run_of(const JournalRecord& record);

}  // namespace trb::scheduler
