// Which run a message or a journal record is about.
#pragma once

#include <string>

#include "common/base/result.hpp"
#include "proto/body.hpp"

namespace trb::scheduler {

/// Of a message: its run's id, also inside a signed order or decision; empty: of none.
std::string named_run(const Body& body);

/// Of a journal record; empty: of the whole journal. Errors: bad_value (no journal record), malformed.
Result<std::string> run_of(const Body& record);

}  // namespace trb::scheduler
