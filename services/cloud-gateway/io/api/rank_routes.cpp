// ahp: what `trb rank` does.
#include "common/operator/rank_text.hpp"
#include "services/cloud-gateway/io/api/api.hpp"

namespace trb::gateway {
namespace {

/// Ranked at once, between two messages of the fleet: this much takes some hundredths of a second at most.
constexpr std::size_t kMaxProblem = 128U << 10U;

void rank_alternatives(const CallPtr& call) {
  if (call->request.body.size() > kMaxProblem) {
    return call->reply(problem_reply(413, "too_large",
                                     "the problem has " + std::to_string(call->request.body.size()) + " bytes",
                                     "send at most " + std::to_string(kMaxProblem) + "; trb rank takes larger ones"));
  }
  const auto answer = op::rank_text(call->request.body, "ranking");
  if (!answer) return call->fail(answer.error());
  call->reply(json_reply(dump_json(ranking_value(*answer))));
}

}  // namespace

void add_rank_routes(Gateway&, HandlerTable& table) {
  table.add(Method::post, "/api/v1/ahp", rank_alternatives);
}

}  // namespace trb::gateway
