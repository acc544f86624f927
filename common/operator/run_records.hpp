#pragma once

#include <string>

#include "common/operator/session.hpp"

namespace trb::op {

/// Of a run's payloads: a gateway makes JSON of them, three to four times as long.
constexpr std::size_t kMostProofBytes = 8U << 20U;

/// Everything that is signed of a run, open or over, as this node's scheduler knows it: all pages as one. `run` as in
/// RunQuery. Errors: unknown_run, expired (its record has made room), missing (archived by an earlier version),
/// conflict (it changes faster than it can be read), too_large, those of Session::request.
void read_run_records(Session& session, const std::string& run, const Callback<RunRecords>& done);

}  // namespace trb::op
