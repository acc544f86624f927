// From a problem to the signed decision, part by part.
#include "services/resilience/test/parts.hpp"
#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

AlertDecide verdict_of(Verdict verdict, const std::string& alert, const std::string& robot = "") {
  return {.alert = alert, .verdict = verdict, .robot = robot, .person = "ann", .reason = ""};
}

}  // namespace

TEST_CASE("detection: a task that has failed is an alert; once it runs again the alert is over") {
  Parts parts;
  Alert& alert = parts.fail_task(0);
  CHECK(alert.robot == "r1");
  CHECK(alert.cause == "task_failed");
  CHECK(alert.tasks == std::vector<std::string>{"t1"});
  REQUIRE_FALSE(alert.proposals.empty());
  parts.view.state = RunState::running;
  parts.view.tasks[0].outcome = TaskOutcome::none;
  parts.tell_view();
  parts.detect();
  CHECK(alert.state == AlertState::closed);
}

TEST_CASE("detection: a robot that has been away for five seconds is an alert, at that moment and without a message") {
  Parts parts;
  parts.tell_routes("r1");
  parts.detect();
  CHECK(parts.alerts.open().empty());
  CHECK(parts.situation.due_runs().next() == parts.now.mono + Liveness::kGrace);
  parts.wait(Liveness::kGrace);
  parts.detect();
  REQUIRE(parts.alerts.open().size() == 1);
  CHECK(parts.alerts.open().front()->cause == "peer_expired");
}

TEST_CASE("proposer: who is proposed is asked for what is not known, and proposed anew once all have answered") {
  Parts parts;
  parts.fail_task(0);
  CHECK_FALSE(parts.take_sent<Opaque>().empty());
  Alert& alert = *parts.alerts.open().front();
  CHECK_FALSE(parts.proposer.is_stale(alert));
  CHECK_FALSE(parts.alerts.work(alert.id).inquiry.is_complete());
  for (const char* robot : {"r2", "r3"}) {
    for (const char* value : {"state_of_charge", "battery", "position"}) {
      parts.proposer.receive(Opaque{value, robot == std::string("r3") ? "90" : "20"}, robot, parts.now, parts.out);
    }
  }
  CHECK(parts.alerts.work(alert.id).inquiry.is_complete());
  CHECK(alert.proposals.front().robot == "r3");
  parts.tell_routes("r3");
  CHECK(parts.proposer.is_stale(alert));
}

TEST_CASE("verdicts: a robot that is not proposed is refused, one that is takes over") {
  Parts parts;
  const Alert& alert = parts.fail_task(0);
  const auto refused =
      parts.verdicts.receive(verdict_of(Verdict::accept, alert.id, "r1"), "cloud", parts.now, parts.out);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == Errc::bad_value);
  const auto foreign = parts.verdicts.receive(verdict_of(Verdict::accept, alert.id), "r2", parts.now, parts.out);
  REQUIRE_FALSE(foreign);
  CHECK(foreign.error().code == Errc::not_permitted);
  CHECK(parts.verdicts.receive(verdict_of(Verdict::accept, alert.id, "r3"), "cloud", parts.now, parts.out));
  CHECK(alert.state == AlertState::releasing);
  CHECK(alert.proposals.front().robot == "r3");
}

TEST_CASE("decisions: a verdict is signed as the next epoch, and handed on until the view shows it") {
  Parts parts;
  Alert& alert = parts.fail_task(0);
  REQUIRE(parts.verdicts.decide(alert, verdict_of(Verdict::accept, alert.id, "r3"), parts.now, parts.out));
  const auto asked = parts.take_sent<SignRequest>();
  REQUIRE(asked.size() == 1);
  const auto decision = decode<Decision>(asked[0].payload.bytes);
  REQUIRE(decision);
  CHECK(decision->epoch == 2);
  REQUIRE(decision->members.size() == 1);
  CHECK(decision->members[0].id == "r3");
  SignedRecord record;
  record.kind = kSignedDecision;
  record.payload = asked[0].payload;
  parts.decisions.receive(record, parts.out);
  CHECK(alert.epoch == 2);
  parts.decisions.advance(alert, parts.now, parts.out);
  CHECK(parts.take_sent<RunDecision>().size() == 1);
  parts.decisions.on_accepted();
  DecisionView shown;
  shown.epoch = 2;
  shown.alert = alert.id;
  parts.view.epoch = 2;
  parts.view.decisions.push_back(shown);
  parts.tell_view();
  parts.decisions.advance(alert, parts.now, parts.out);
  CHECK(alert.state == AlertState::decided);
}

TEST_CASE("decisions: what the scheduler refuses opens the alert again, what it did not get is sent again") {
  Parts parts;
  Alert& alert = parts.fail_task(0);
  REQUIRE(parts.verdicts.decide(alert, verdict_of(Verdict::accept, alert.id), parts.now, parts.out));
  SignedRecord record;
  record.kind = kSignedDecision;
  record.payload = parts.take_sent<SignRequest>().at(0).payload;
  parts.decisions.receive(record, parts.out);
  parts.decisions.advance(alert, parts.now, parts.out);
  parts.decisions.on_refused(Nack{"timeout", std::string(RunDecision::kSubtype), "cloud", "no answer", ""}, parts.out);
  parts.decisions.advance(alert, parts.now, parts.out);
  CHECK(alert.state == AlertState::releasing);
  parts.decisions.on_refused(Nack{"conflict", std::string(RunDecision::kSubtype), "cloud", "another", ""}, parts.out);
  parts.decisions.advance(alert, parts.now, parts.out);
  CHECK(alert.state == AlertState::open);
  CHECK(alert.text.ends_with("its decision was refused: another"));
}

TEST_CASE("policy: it waits for other failures of the same cause and for answers, then decides") {
  Parts parts(Role::cloud, automatic());
  Alert& alert = parts.fail_task(0);
  parts.policy.try_decide(alert, parts.now, parts.out);
  CHECK(alert.policy == "automatic, waits: other tasks may fail of the same cause");
  CHECK(alert.state == AlertState::open);
  parts.wait(seconds(3));
  parts.policy.try_decide(alert, parts.now, parts.out);
  CHECK(alert.policy.starts_with("automatic, waits: what r"));
  parts.wait(seconds(3));
  parts.policy.try_decide(alert, parts.now, parts.out);
  CHECK(alert.policy == "automatic");
  CHECK(alert.state == AlertState::releasing);
}

TEST_CASE("open alerts: nobody has decided in time") {
  Parts parts;
  Alert& alert = parts.fail_task(0);
  parts.alert_updater.look(alert, parts.now, parts.out);
  CHECK(alert.waits_for.starts_with("a verdict: trb alert decide"));
  parts.now.utc = parts.now.utc + seconds(3600);  // a clock that was put right tells nothing of how long nobody decided
  parts.alert_updater.look(alert, parts.now, parts.out);
  CHECK(alert.state == AlertState::open);
  parts.wait(default_resilience().expires);
  parts.alert_updater.look(alert, parts.now, parts.out);
  CHECK(alert.state == AlertState::expired);
}

TEST_CASE("standing alerts: a fault that no run's alert tells of is an alert of its own, until it is over") {
  Parts parts;
  parts.break_down("r3");
  parts.standing.raise_due(parts.now, parts.out);
  CHECK(parts.alerts.open().empty());
  CHECK(parts.standing.next(parts.now) == parts.now.mono + UncoveredFaults::kSettle);
  parts.wait(UncoveredFaults::kSettle);
  parts.standing.raise_due(parts.now, parts.out);
  REQUIRE(parts.alerts.open().size() == 1);
  Alert& alert = *parts.alerts.open().front();
  CHECK(alert.run.empty());
  CHECK(alert.text == "a wheel is off");
  parts.situation.fleet().end_faults("r3", "mobile", "repaired", parts.now.utc);
  parts.standing.look(alert, parts.now, parts.out);
  CHECK(alert.state == AlertState::closed);
}

TEST_CASE("repairs: the robot's node is told to take into use what its profile has as broken, and refuses") {
  Parts parts;
  NodeProfile profile = mobile_robot();
  OutOfUse broken;
  broken.capability = "mobile";
  broken.severity = Severity::critical;
  broken.text = "a wheel is off";
  profile.out_of_use = {broken};
  REQUIRE(parts.situation.fleet().on_route(route_of("r3", profile), parts.now.utc));
  Alert& alert = *parts.standing.raise({"r3", "mobile"}, parts.now, parts.out);
  CHECK(parts.repairs.still_broken(alert) == std::vector<std::string>{"mobile"});
  CHECK(parts.repairs.is_awaited(alert, parts.now, parts.out));
  REQUIRE(parts.take_sent<TakeIntoUse>().size() == 1);
  const Nack nack{"conflict", std::string(TakeIntoUse::kSubtype), "r3", "it does not turn", ""};
  parts.repairs.on_refused(nack, "r3", parts.now, parts.out);
  parts.wait(RepairReport::kProfile);
  CHECK(parts.repairs.is_awaited(alert, parts.now, parts.out));
  CHECK(alert.text.ends_with("r3 does not take it into use: it does not turn"));
}
