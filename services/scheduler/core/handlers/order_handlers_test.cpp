// Orders to abort, to hold and to let go on: a person's, and a node's own.
#include <doctest/doctest.h>

#include "common/scenario/run_start.hpp"
#include "services/scheduler/core/handlers/abort_handler.hpp"
#include "services/scheduler/core/handlers/pause_handler.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Names = std::vector<std::string>;

Scenario failing() {
  Scenario scenario = chain({"ur3", "drone"});
  scenario.tasks[0].on_failure = OnFailure::abort;
  return scenario;
}

struct Ordering {
  explicit Ordering(const std::string& self = "ur3") : known(failing(), self) {}

  Outbox at_end_of_step() {
    Outbox out;
    aborts.confirm(known.run(), known.step(out));
    aborts.order_on_failure(known.run(), known.step(out));
    pauses.hold_for_doubles(known.run(), known.step(out));
    return out;
  }
  void finish_twice() {
    for (const char* data : {"", "again"}) {
      known.add(known.result("task-0", "ur3", TaskOutcome::finished, 1, data));
    }
  }
  [[nodiscard]] const Orders& orders() const { return known.run().orders(); }

  KnownRun known;
  AbortHandler aborts{known.self, known.runs, known.executor, known.lookup, known.journal};
  PauseHandler pauses{known.self, known.executor, known.lookup, known.journal};
};

}  // namespace

TEST_CASE("an order of a peer is journaled, owed to all, and confirmed once nothing runs here") {
  Ordering ordering;
  const Outbox out = ordering.known.send(ordering.aborts, "cloud", RunAbort{ordering.known.abort()});
  CHECK(out.journal.size() == 1);
  CHECK(ordering.orders().is_aborted());
  CHECK(targets<AbortConfirmed>(ordering.at_end_of_step()) == Names{"cloud"});
  CHECK(targets<AbortConfirmed>(ordering.at_end_of_step()).empty());
}

TEST_CASE("an abort is confirmed to a member once it has the result that it is owed") {
  Ordering ordering;
  ordering.known.finish("task-0");
  ordering.known.send(ordering.aborts, "cloud", RunAbort{ordering.known.abort()});
  ordering.known.send(ordering.aborts, "drone", RunAbort{ordering.known.abort()});
  CHECK(targets<AbortConfirmed>(ordering.at_end_of_step()) == Names{"drone"});
  CHECK(ordering.known.run().deliveries().settle(DeliveryKind::results, "cloud", {0}));
  CHECK(targets<AbortConfirmed>(ordering.at_end_of_step()) == Names{"cloud"});
}

TEST_CASE("an aborted run waits for no node whose certificate is revoked, also after a restart") {
  Ordering ordering;
  ordering.known.finish("task-0");
  const auto end_step = [&] {
    Outbox out;
    ordering.aborts.give_up_revoked(ordering.known.run(), ordering.known.step(out));
    return out;
  };
  const auto tell = [&](const std::string& by, const char* reason) {
    return ordering.known.send(ordering.aborts, by, PeerExpired{"cloud", reason}, MessageType::information);
  };
  const auto& owed = ordering.known.run().deliveries().pending();
  CHECK(nacks(tell("drone", "cert_revoked: a lie")).empty());
  tell("ur3", "10 s unheard");
  ordering.known.send(ordering.aborts, "drone", RunAbort{ordering.known.abort("drone")});
  CHECK(end_step().journal.empty());
  tell("ur3", "cert_revoked: stolen");
  const Outbox out = end_step();
  CHECK(owed.owed_to("cloud").empty());
  CHECK_FALSE(owed.owed_to("drone").empty());
  KnownRun restarted(failing());
  restarted.finish("task-0");
  REQUIRE(restarted.run().apply(JournalAbort{restarted.abort("drone"), false}).ok());
  CHECK_FALSE(restarted.run().deliveries().pending().owed_to("cloud").empty());
  for (const Journal& record : out.journal) {
    REQUIRE(restarted.run().apply(std::any_cast<JournalDelivered>(record.record)).ok());
  }
  CHECK(restarted.run().deliveries().pending().owed_to("cloud").empty());
}

TEST_CASE("an aborted run waits for no node that was revoked before this service began, unless it is a member again") {
  Ordering ordering;
  const std::uint64_t serial = ordering.known.run().members().find("cloud")->serial;
  ordering.known.send(ordering.aborts, "drone", RunAbort{ordering.known.abort("drone")});
  const auto& owed = ordering.known.run().deliveries().pending();
  const auto tell = [&](const std::string& by, const auto& body) {
    ordering.known.send(ordering.aborts, by, body, MessageType::information);
    Outbox out;
    ordering.aborts.give_up_revoked(ordering.known.run(), ordering.known.step(out));
    return owed.owes(DeliveryKind::abort, "cloud");
  };
  CHECK(tell("drone", RevokedNodes{{{"cloud", serial}}}));  // a lie
  CHECK(tell("ur3", RevokedNodes{{{"cloud", serial - 1}}}));
  CHECK_FALSE(tell("ur3", RevokedNodes{{{"cloud", serial}}}));
  CHECK(tell("ur3", PeerJoined{"cloud", 7}));
}

TEST_CASE("a node that is a member again gets what it is owed") {
  Ordering ordering;
  const auto tell = [&](const auto& body) {
    ordering.known.send(ordering.aborts, "ur3", body, MessageType::information);
  };
  tell(PeerExpired{"cloud", "cert_revoked: lost"});
  tell(PeerJoined{"cloud", 7});
  ordering.known.send(ordering.aborts, "drone", RunAbort{ordering.known.abort("drone")});
  Outbox out;
  ordering.aborts.give_up_revoked(ordering.known.run(), ordering.known.step(out));
  CHECK(out.journal.empty());
}

TEST_CASE("a node that is a member again is owed the abort that was given up, once") {
  Ordering ordering;
  const auto tell = [&](const auto& body) {
    ordering.known.send(ordering.aborts, "ur3", body, MessageType::information);
  };
  const auto& owed = ordering.known.run().deliveries().pending();
  ordering.known.send(ordering.aborts, "drone", RunAbort{ordering.known.abort("drone")});
  tell(PeerExpired{"cloud", "cert_revoked: stolen"});
  tell(PeerExpired{"stranger", "cert_revoked: stolen"});
  Outbox out;
  ordering.aborts.give_up_revoked(ordering.known.run(), ordering.known.step(out));
  REQUIRE_FALSE(owed.owes(DeliveryKind::abort, "cloud"));
  tell(PeerJoined{"cloud", 7});
  tell(PeerJoined{"stranger", 7});
  CHECK(owed.owes(DeliveryKind::abort, "cloud"));
  CHECK_FALSE(owed.owes(DeliveryKind::abort, "stranger"));
  ordering.known.send(ordering.aborts, "cloud", AbortConfirmed{kKnownRun}, MessageType::information);
  tell(PeerJoined{"cloud", 8});
  CHECK_FALSE(owed.owes(DeliveryKind::abort, "cloud"));
}

TEST_CASE("a person's order on this node is answered") {
  Ordering ordering("cloud");
  Outbox out;
  Inbound request = ordering.known.from("cloud", MessageType::request, RunAbort{ordering.known.abort()});
  ordering.aborts.handle(RunAbort{ordering.known.abort()}, request, ordering.known.step(out));
  CHECK(sent<Ack>(out).size() == 1);
}

TEST_CASE("a task whose failure ends the run makes its robot order the abort, once it is signed") {
  Ordering ordering;
  CHECK(sent<SignRequest>(ordering.at_end_of_step()).empty());
  ordering.known.add(ordering.known.result("task-0", "ur3", TaskOutcome::failed));
  const SignedRecord order = signed_by(ordering.known.signers, "ur3", ordering.at_end_of_step());
  CHECK(sent<SignRequest>(ordering.at_end_of_step()).empty());  // already requested
  Outbox out;
  CHECK_FALSE(ordering.aborts.keep_signed(ordering.known.run(), ordering.known.abort(), ordering.known.step(out)));
  CHECK(ordering.aborts.keep_signed(ordering.known.run(), order, ordering.known.step(out)));
  CHECK(ordering.orders().is_aborted());
}

TEST_CASE("an abort of a task that got no robot in time is taken back if it may begin before the order is signed") {
  KnownRun known(chain({"ur3"}), "cloud");
  const Signers& signers = known.signers;
  Scenario scenario = chain({"drone", ""});
  scenario.tasks[0].after.clear();
  scenario.tasks[1].after.clear();
  scenario.tasks[1].requires_ = {"mobile"};
  scenario.tasks[1].start_within_s = 12;
  scenario.tasks[1].on_failure = OnFailure::abort;
  const std::string id(32, 'b');
  const UtcTime made = known.now.utc;
  auto opened = known.runs.open(signers.sign("cloud", kSignedRunStart,
                                             encode(build_run_start(scenario, signers.members(), "cloud", made,
                                                                    made + seconds(3600), id, {"drone", "cloud"}))));
  REQUIRE(opened.ok());
  Run& run = known.runs.add(std::move(*opened));
  TaskResult released;
  released.key = {id, "task-1", 1, 1};
  released.digest = run.definition().start().digest;
  released.robot = "cloud";
  released.outcome = TaskOutcome::released;
  REQUIRE(run.apply(JournalResult{signers.sign("cloud", kSignedResult, encode(released))}).ok());
  run.work().timers().set_unbound({1}, known.now.mono);
  known.pass(13);
  AbortHandler aborts{known.self, known.runs, known.executor, known.lookup, known.journal};
  const auto ask = [&] {
    Outbox out;
    aborts.order_on_failure(run, known.step(out));
    return out;
  };
  const SignedRecord order = signed_by(signers, "cloud", ask());
  SUBCASE("a robot was chosen") {
    Decision chosen;
    chosen.run = id;
    chosen.digest = released.digest;
    chosen.epoch = 2;
    chosen.by = "cloud";
    chosen.tasks = {{"task-1", Ruling::move, "ur3", 2, Evidence::result}};
    REQUIRE(run.apply(JournalDecision{signers.sign("cloud", kSignedDecision, encode(chosen)), true}).ok());
  }
  SUBCASE("a person holds the run") {
    const PauseOrder hold{id, 1, true, "cloud", "", 1, {}};
    REQUIRE(run.apply(JournalPause{signers.sign("cloud", kSignedRunPause, encode(hold)), true}).ok());
  }
  known.pass(10);
  CHECK(sent<SignRequest>(ask()).empty());
  Outbox out;
  CHECK_FALSE(aborts.keep_signed(run, order, known.step(out)));
  CHECK_FALSE(run.orders().is_aborted());
}

TEST_CASE("a node whose router signs nothing gives up its order to abort once the run is over: no time is missed") {
  Ordering ordering;
  ordering.known.add(ordering.known.result("task-0", "ur3", TaskOutcome::failed));
  CHECK(sent<SignRequest>(ordering.at_end_of_step()).size() == 1);
  CHECK(ordering.known.run().work().next() > ordering.known.now.mono);
  ordering.known.pass(4000);  // it has expired
  CHECK(sent<SignRequest>(ordering.at_end_of_step()).empty());
  CHECK_FALSE(ordering.known.run().work().next().has_value());
}

TEST_CASE("an order to hold is journaled and confirmed with the number that counts") {
  Ordering ordering;
  const Outbox out = ordering.known.send(ordering.pauses, "cloud", RunPause{ordering.known.pause(2, true)});
  CHECK(ordering.orders().is_held());
  REQUIRE(sent<PauseJournaled>(out).size() == 1);
  CHECK(sent<PauseJournaled>(out)[0].number == 2);
  const Outbox older = ordering.known.send(ordering.pauses, "cloud", RunPause{ordering.known.pause(1, false)});
  CHECK(ordering.orders().is_held());
  CHECK(sent<PauseJournaled>(older)[0].number == 2);
}

TEST_CASE("the judge holds a run in which a task was done twice, until a person has looked at it") {
  Ordering judge("cloud");
  judge.finish_twice();
  const SignedRecord order = signed_by(judge.known.signers, "cloud", judge.at_end_of_step());
  Outbox out;
  REQUIRE(judge.pauses.keep_signed(judge.known.run(), order, judge.known.step(out)));
  CHECK(judge.orders().is_held_for_doubles());
  const RunPause blind{judge.known.pause(2, false)};
  CHECK(nacks(judge.known.send(judge.pauses, "cloud", blind)) == Names{"conflict"});
  CHECK(judge.orders().is_held());
  judge.known.send(judge.pauses, "cloud", RunPause{judge.known.pause(2, false, {"task-0"})});
  CHECK_FALSE(judge.orders().is_held());
  CHECK(sent<SignRequest>(judge.at_end_of_step()).empty());
}

TEST_CASE("a judge that has lost what was done twice holds the run anew by its own earlier order") {
  Ordering judge("cloud");
  REQUIRE(judge.known.run().apply(JournalPause{judge.known.pause(1, true, {"task-0"}), false}).ok());
  judge.known.send(judge.pauses, "drone", RunPause{judge.known.pause(2, false, {}, "drone")});
  const SignedRecord order = signed_by(judge.known.signers, "cloud", judge.at_end_of_step());
  const auto again = decode<PauseOrder>(order.payload.bytes);
  CHECK(again->number == 3);
  CHECK(again->doubles == Names{"task-0"});
  CHECK(again->reason == "task 'task-0' has two different results (double_execution)");
}

TEST_CASE("what an earlier version has journaled of a member that may not say what was done twice does not count") {
  Ordering judge("cloud");
  REQUIRE(judge.known.run().apply(JournalPause{judge.known.pause(1, true, {"x"}, "drone"), false}).ok());
  REQUIRE(judge.known.run().apply(JournalPause{judge.known.pause(2, false, {"task-0"}, "drone"), false}).ok());
  CHECK(judge.orders().pause() == nullptr);
  judge.finish_twice();
  CHECK(decode<PauseOrder>(signed_by(judge.known.signers, "cloud", judge.at_end_of_step()).payload.bytes)->doubles ==
        Names{"task-0"});
}

TEST_CASE("who is no judge holds nothing by itself") {
  Ordering member("ur3");
  member.finish_twice();
  CHECK(sent<SignRequest>(member.at_end_of_step()).empty());
}

TEST_CASE("an order is owed to a member until it has journaled that one") {
  Ordering ordering;
  ordering.known.send(ordering.pauses, "cloud", RunPause{ordering.known.pause(3, true)});
  const PendingDeliveries& pending = ordering.known.run().deliveries().pending();
  CHECK_FALSE(pending.owes(DeliveryKind::pause, "cloud"));  // it has sent the order itself
  ordering.known.send(ordering.pauses, "drone", PauseJournaled{kKnownRun, 2});
  CHECK(pending.owes(DeliveryKind::pause, "drone"));
  ordering.known.send(ordering.pauses, "drone", PauseJournaled{kKnownRun, 3});
  CHECK_FALSE(pending.owes(DeliveryKind::pause, "drone"));
}
