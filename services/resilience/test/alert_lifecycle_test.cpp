#include "services/resilience/core/alert_lifecycle.hpp"

#include "services/resilience/test/parts.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

/// A decided alert of run1.
Alert& decided(Parts& parts) {
  Alert& alert = *parts.alerts.raise(alert_of(parts.run(), "r1", parts.now), parts.now, parts.out);
  alert.state = AlertState::releasing;
  alert.verdict = Verdict::accept;
  alert.person = "ann";
  alert.epoch = 2;
  parts.out = {};
  return alert;
}

/// How each decision that the step let go of ended.
std::vector<DecisionEnd> ends(const Outbox& out) {
  std::vector<DecisionEnd> found;
  for (const Journal& one : out.journal) {
    if (const auto* over = std::any_cast<DecisionOver>(&one.record)) found.push_back(over->end);
  }
  return found;
}

}  // namespace

TEST_CASE("an alert that is closed is over, its decision is dropped, and its run is looked at") {
  Parts parts;
  Alert& alert = decided(parts);
  parts.alerts.close(alert, "the fault is over", parts.out);
  CHECK(alert.state == AlertState::closed);
  CHECK(alert.waits_for == "the fault is over");
  CHECK(parts.alerts.open().empty());
  CHECK(ends(parts.out) == std::vector{DecisionEnd::dropped});
  CHECK(parts.situation.due_runs().has_notified());
}

TEST_CASE("an alert whose decision the scheduler has is decided") {
  Parts parts;
  Alert& alert = decided(parts);
  parts.alerts.finish(alert, parts.out);
  CHECK(alert.state == AlertState::decided);
  CHECK(ends(parts.out) == std::vector{DecisionEnd::handed});
  CHECK(parts.alerts.find_work(alert.id) == nullptr);
}

TEST_CASE("an alert that is open again has no verdict, says why, and the policy does not try the same again") {
  Parts parts;
  Alert& alert = decided(parts);
  alert.text = "a wheel is off";
  parts.alerts.work(alert.id).signing.restore({}, 2);
  parts.alerts.reopen(alert, "its decision was refused", parts.out);
  CHECK(alert.state == AlertState::open);
  CHECK(alert.verdict == Verdict::none);
  CHECK(alert.person.empty());
  CHECK(alert.epoch == 0);
  CHECK(alert.text == "a wheel is off; tried in vain: its decision was refused");
  CHECK(parts.alerts.work(alert.id).asks_for == "its decision was refused");
  CHECK_FALSE(parts.alerts.work(alert.id).signing.record());
}

TEST_CASE("the last answer that an alert waits for makes alerts due") {
  Parts parts;
  Alert& alert = decided(parts);
  Inquiry& inquiry = parts.alerts.work(alert.id).inquiry;
  REQUIRE(inquiry.begin(parts.now));
  inquiry.await("r2", "battery");
  parts.situation.take_change();
  parts.alerts.on_answer("r3", "battery");
  CHECK_FALSE(parts.situation.take_change());
  parts.alerts.on_answer("r2", "battery");
  CHECK(parts.situation.take_change());
}

TEST_CASE("a signed decision is there again after a restart, unless the scheduler has it") {
  Parts parts;
  const Alert alert = decided(parts);
  Decision decision;
  decision.alert = alert.id;
  decision.epoch = 2;
  SignedRecord record;
  record.payload.bytes = encode(decision);
  for (const bool delivered : {false, true}) {
    AlertLifecycle again(parts.situation);
    again.restore({alert}, {{record, delivered}});
    const AlertWork* work = again.find_work(alert.id);
    CHECK((work != nullptr && work->signing.epoch() == 2) == !delivered);
  }
}
