#include "common/operator/decide.hpp"

namespace trb::op {

Status check_subject(const AlertDecide& decision) {
  if (decision.alert.empty() == decision.run.empty()) {
    return fail(Errc::missing, "an alert, or a run and its tasks",
                "trb alert decide ALERT, or trb alert decide --run RUN --task T[,T]");
  }
  if (decision.alert.empty() && decision.tasks.empty())
    return fail(Errc::missing, "which tasks of the run", "--task T[,T]");
  return Done{};
}

Status check_decision(const AlertDecide& decision) {
  if (Status subject = check_subject(decision); !subject) return subject;
  const bool of_run = decision.alert.empty();
  if (of_run && (decision.verdict == Verdict::none || decision.verdict == Verdict::abort)) {
    return fail(Errc::missing, "what is to become of the tasks", "--robot, --override, --retry or --skip");
  }
  if (decision.verdict == Verdict::override_ && decision.reason.empty()) {
    return fail(Errc::missing, "an override needs a reason", "--reason TEXT");
  }
  return Done{};
}

namespace {

/// Another cloud node decides on the run: it gets the verdict from here, and knows run and tasks by the same names.
void decide_there(Session& session, AlertDecide decision, const Result<DecidedElsewhere>& place,
                  const Callback<Ack>& done) {
  if (!place) return done(place.error());
  decision.run = place->run;
  decision.tasks = place->tasks;
  const auto answered = [done](const Message& answer) { done(decode<Ack>(answer.data)); };
  session.command(place->node, std::move(decision), on_success<Message>(done, answered));
}

}  // namespace

void decide(Session& session, const AlertDecide& decision, const Callback<Ack>& done) {
  if (const Status sound = check_decision(decision); !sound)
    return session.after(Duration::zero(), [done, why = sound.error()] { done(why); });
  const auto answered = [&session, decision, done](const Message& answer) {
    if (answer.subtype != DecidedElsewhere::kSubtype) return done(decode<Ack>(answer.data));
    decide_there(session, decision, decode<DecidedElsewhere>(answer.data), done);
  };
  session.command(session.node(), decision, on_success<Message>(done, answered));
}

}  // namespace trb::op
