#include "common/operator/submit_run.hpp"

#include <set>

#include "common/operator/send_signed.hpp"
#include "common/scenario/run_id.hpp"
#include "common/scenario/run_start.hpp"

namespace trb::op {
namespace {

/// The run's robots, the own node, and every cloud node: those whose certificates the run needs.
Result<std::vector<Member>> members_of(const RunPlan& plan) {
  std::set<std::string> wanted{plan.table.node};
  wanted.insert(plan.robots.begin(), plan.robots.end());
  std::vector<Member> out;
  for (const Route& route : plan.table.routes) {
    if (wanted.erase(route.id) != 0 || route.role == Role::cloud) out.push_back({route.id, route.certificate});
  }
  if (!wanted.empty())
    return fail(Errc::unknown_target, "node '" + *wanted.begin() + "' is not known", "see trb route list");
  return out;
}

}  // namespace

void submit_run(Session& session, RunPlan plan, const RunTerms& terms, const Callback<std::string>& done) {
  auto members = members_of(plan);
  if (!members) return session.after(Duration::zero(), [done, why = members.error()] { done(why); });
  const UtcTime now = session.now().utc;
  const RunStart start = build_run_start(
      std::move(plan.scenario), std::move(*members), session.node(), now, now + seconds(terms.expires_h * 3600),
      make_run_id(session.node(), session.random_bytes(kRunIdRandom)), std::move(plan.robots), terms.priority);
  const auto accepted = [done](const Message& answer) {
    const auto body = decode<RunAccepted>(answer.data);
    done(body ? Result<std::string>(body->run) : Result<std::string>(body.error()));
  };
  send_signed<RunSubmit>(session, kSignedRunStart, encode(start), on_success<Message>(done, accepted));
}

}  // namespace trb::op
