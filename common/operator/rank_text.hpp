#pragma once

#include <string>

#include "common/base/bytes.hpp"
#include "common/ranking/ranking_json.hpp"

namespace trb::op {

/// Ranks the alternatives of a problem in JSON (config/rank/README.md); needs no node. `name` stands for the text in
/// errors. Errors: those of parse_json, read_ranking and rank.
Result<RankingAnswer> rank_text(BytesView text, const std::string& name);

}  // namespace trb::op
