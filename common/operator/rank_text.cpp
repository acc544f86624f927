#include "common/operator/rank_text.hpp"

namespace trb::op {

Result<RankingAnswer> rank_text(BytesView text, const std::string& name) {
  const auto json = parse_json(text, kRankingLimits);
  if (!json) return fail(json.error().code, name + ": " + json.error().what, json.error().hint);
  const auto problem = read_ranking(*json);
  return problem ? rank(*problem) : problem.error();
}

}  // namespace trb::op
