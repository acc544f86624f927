// A ranking's problem and its answer as JSON: what `trb rank` reads and prints (config/schemas/rank.schema.json).
#pragma once

#include "common/ranking/ranking.hpp"
#include "proto/value.hpp"

namespace trb {

/// The most that a file of a ranking may hold: 20,000 alternatives with ten values each.
constexpr ParseLimits kRankingLimits{.bytes = 16U << 20U, .depth = 32, .values = 500'000};

/// Errors name the key: bad_value, missing, unknown_key, duplicate, too_large. What rank() checks is not checked here.
Result<RankingProblem> read_ranking(const Value& json);

/// {"criteria", "consistency", "ranking", "sensitivity"}
Value ranking_value(const RankingAnswer& answer);

}  // namespace trb
