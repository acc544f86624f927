#include "common/operator/submit_run.hpp"

#include <set>

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

Error not_confirmed(const std::string& run, const Error& why) {
  return fail(Errc::not_confirmed, "run " + run + " was submitted, and may still begin: " + why.what,
              "do not start it again before you have looked: trb run show " + run + ", trb scenario abort " + run);
}

/// The scheduler takes the same start twice, so it is sent again if no answer comes.
void send_start(Session& session, const RunSubmit& start, const std::string& run, bool again,
                const Callback<std::string>& done) {
  const auto take = [&session, start, run, again, done](const Result<Message>& answer) {
    if (answer) {
      const auto body = decode<RunAccepted>(answer->data);
      return done(body ? Result<std::string>(body->run) : Result<std::string>(body.error()));
    }
    if (again) return done(not_confirmed(run, answer.error()));
    if (answer.error().code != Errc::timeout) return done(answer.error());
    send_start(session, start, run, true, done);
  };
  session.command(session.node(), start, take);
}

}  // namespace

void submit_run(Session& session, RunPlan plan, const RunTerms& terms, const Callback<std::string>& done) {
  auto members = members_of(plan);
  if (!members) return session.after(Duration::zero(), [done, why = members.error()] { done(why); });
  const UtcTime now = session.now().utc;
  const RunStart start = build_run_start(
      std::move(plan.scenario), std::move(*members), session.node(), now, now + seconds(terms.expires_h * 3600),
      make_run_id(session.node(), session.random_bytes(kRunIdRandom)), std::move(plan.robots), terms.priority);
  const auto submit = [&session, run = start.run, done](SignedRecord record) {
    send_start(session, RunSubmit{std::move(record)}, run, false, done);
  };
  session.ask_node<SignedRecord>(SignRequest{std::string(kSignedRunStart), {encode(start)}},
                                 on_success<SignedRecord>(done, submit));
}

}  // namespace trb::op
