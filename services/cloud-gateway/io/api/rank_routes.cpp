// ahp: what `trb rank` does; the ranking of an alert's candidates by other weights.
#include <algorithm>

#include "common/operator/rank_alert.hpp"
#include "common/operator/rank_text.hpp"
#include "services/cloud-gateway/io/api/api.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

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

// ---- an alert's candidates

struct RankingWish {
  std::vector<WeighedCriterion> weights;  ///< empty: those in force
  std::optional<Consistency> consistency;
};

Result<RankingWish> read_weights(const Value& json) {
  if (!json.is_object() || json.object().empty() || json.object().size() > kMaxRankedCriteria) {
    return fail(Errc::bad_value, "weights: is no object of 1 to " + std::to_string(kMaxRankedCriteria) + " weights",
                R"(write {"battery": 1, "distance": 2})");
  }
  RankingWish out;
  for (const auto& [name, weight] : json.object()) {
    if (!weight.is_number()) {
      return fail(Errc::bad_value, "weights." + name.substr(0, 64) + ": is no number", "write a number from 0");
    }
    out.weights.push_back({name, weight.number()});
  }
  return out;
}

Result<Judgment> read_judgment(const Value& json, std::size_t index) {
  if (json.is_list() && json.list().size() == 3 && json.list()[0].is_text() && json.list()[1].is_text() &&
      json.list()[2].is_number()) {
    return Judgment{json.list()[0].text(), json.list()[1].text(), json.list()[2].number()};
  }
  return fail(Errc::bad_value, "judgments[" + std::to_string(index) + "]: is no judgment",
              R"(write ["battery", "distance", 3]: battery counts 3 times as much as distance)");
}

/// The criteria that are judged, in the order in which they are named; the others count nothing.
std::vector<std::string> judged_names(const std::vector<Judgment>& judgments) {
  std::vector<std::string> out;
  for (const Judgment& one : judgments) {
    for (const std::string& name : {one.a, one.b}) {
      if (std::ranges::find(out, name) == out.end()) out.push_back(name);
    }
  }
  return out;
}

Result<RankingWish> read_judgments(const Value& json) {
  constexpr std::size_t kMost = kMostJudged * (kMostJudged - 1);
  if (!json.is_list() || json.list().empty() || json.list().size() > kMost) {
    return fail(Errc::bad_value, "judgments: is no list of 1 to " + std::to_string(kMost) + " judgments",
                R"(write [["battery", "distance", 3]])");
  }
  std::vector<Judgment> judgments;
  for (std::size_t i = 0; i < json.list().size(); ++i) {
    auto one = read_judgment(json.list()[i], i);
    if (!one) return one.error();
    judgments.push_back(std::move(*one));
  }
  const std::vector<std::string> names = judged_names(judgments);
  const auto weighed = weigh("judgments", names, {{1, judgments, ""}}, WeightMethod::eigenvector);
  if (!weighed) return weighed.error();
  RankingWish out;
  out.consistency = weighed->consistency;
  for (std::size_t i = 0; i < names.size(); ++i) out.weights.push_back({names[i], weighed->weights[i]});
  return out;
}

/// {"weights": {NAME: NUMBER}} or {"judgments": [[A, B, TIMES]]}
Result<RankingWish> ranking_wish(const Call& call) {
  if (call.request.body.empty()) return RankingWish{};
  const auto body = Members::of(call, {"weights", "judgments"});
  if (!body) return body.error();
  if (body->has("weights") && body->has("judgments")) {
    return fail(Errc::bad_value, "judgments: there are weights, too", "send one of them");
  }
  if (const Value* weights = body->value("weights")) return read_weights(*weights);
  const Value* judgments = body->value("judgments");
  return judgments != nullptr ? read_judgments(*judgments) : Result<RankingWish>(RankingWish{});
}

std::string json_ranking(const AlertRanking& ranking, const std::optional<Consistency>& consistency) {
  std::string out = to_json(ranking);
  if (!consistency) return out;
  JsonObject of;
  of.raw("lambda_max", dump_json(Value{consistency->lambda_max})).raw("ci", dump_json(Value{consistency->ci}));
  out.back() = ',';
  return out + "\"consistency\":" + of.raw("cr", dump_json(Value{consistency->cr})).done() + "}";
}

void rank_candidates(Gateway& gateway, const CallPtr& call) {
  const auto wish = ranking_wish(*call);
  if (!wish) return call->fail(wish.error());
  op::rank_alert(gateway.session, {call->parameter("alert"), wish->weights},
                 [call, consistency = wish->consistency](const Result<AlertRanking>& ranking) {
                   if (!ranking) return call->fail(ranking.error());
                   call->reply(json_reply(json_ranking(*ranking, consistency)));
                 });
}

}  // namespace

void add_rank_routes(Gateway& gateway, HandlerTable& table) {
  table.add(Method::post, "/api/v1/ahp", rank_alternatives);
  table.add(Method::post, "/api/v1/alerts/{alert}/ranking",
            [&](const CallPtr& call) { rank_candidates(gateway, call); });
}

}  // namespace trb::gateway
