#pragma once

#include "common/operator/session.hpp"
#include "proto/bodies/resilience.hpp"

namespace trb::op {

/// Ranks an open alert's candidates by other weights, with values that the robots send now: the ranking is requested
/// again until they have answered, for `patience` at most. Errors: those of Session::request.
void rank_alert(Session& session, AlertRankRequest request, Callback<AlertRanking> done,
                Duration patience = std::chrono::seconds(2));

}  // namespace trb::op
