#include "common/operator/rank_alert.hpp"

#include <memory>

namespace trb::op {
namespace {

constexpr Duration kAgain = std::chrono::milliseconds(200);

struct Ranking {
  AlertRankRequest request;
  Callback<AlertRanking> done;
  MonotonicTime until;
};

void request_ranking(Session& session, const std::shared_ptr<const Ranking>& ranking) {
  session.ask_node<AlertRanking>(ranking->request, [&session, ranking](Result<AlertRanking> answer) {
    const bool is_last = !answer || answer->complete || session.now().mono >= ranking->until;
    if (is_last) return ranking->done(std::move(answer));
    session.after(kAgain, [&session, ranking] { request_ranking(session, ranking); });
  });
}

}  // namespace

void rank_alert(Session& session, AlertRankRequest request, Callback<AlertRanking> done, Duration patience) {
  const MonotonicTime until = session.now().mono + patience;
  request_ranking(session, std::make_shared<const Ranking>(Ranking{std::move(request), std::move(done), until}));
}

}  // namespace trb::op
