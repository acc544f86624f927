// The robot's attempt: what begins it, the mode-adapter's reports, and its signed result.
#include "services/scheduler/core/handlers/robot_handler.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/core/handlers/refusal_handler.hpp"
#include "services/scheduler/core/robot_schedule.hpp"
#include "services/scheduler/test/known_run.hpp"
#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Names = std::vector<std::string>;

struct Working {
  explicit Working(const Scenario& scenario = chain({"ur3", "drone"}), Bytes key = {},
                   std::size_t most_bytes = RunStore::kMostBytes)
      : known(scenario, "ur3", most_bytes), schedule(known.runs, known.executor, lost, std::move(key)) {}

  Outbox tell_online() {
    AdapterState state;
    state.instance = 5;
    state.robot = "ONLINE";
    return known.send(robot, "ur3", state, MessageType::information);
  }
  Outbox at_end_of_step() {
    Outbox out;
    schedule.update_due(known.run(), known.step(out));
    schedule.fail_late(known.run(), known.step(out));
    schedule.permit_attempt(known.step(out));
    known.executor.tick(known.now, out);
    schedule.start_next(known.step(out));
    return out;
  }
  /// The task is commanded.
  Execute start() {
    tell_online();
    const auto commands = sent<Execute>(at_end_of_step());
    REQUIRE(commands.size() == 1);
    return commands.front();
  }
  Outbox tell_outcome(TaskOutcome how) {
    Outcome outcome;
    outcome.key = {kKnownRun, "task-0", 1, 1};
    outcome.instance = 5;
    outcome.outcome = how;
    return known.send(robot, "ur3", outcome, MessageType::information);
  }
  Outbox refuse(const char* code, const char* subtype) {
    const Nack nack{code, subtype, "ur3", "no", "", kKnownRun};
    return known.send(refusals, "ur3", nack, MessageType::information);
  }

  /// What its outcome is signed with is not what the run knows of this node.
  Outbox sign_with_new_keys(const Outbox& request) {
    known.signers.add("ur3", Role::robot);
    Outbox out;
    const SignedRecord result = signed_by(known.signers, "ur3", request);
    CHECK(robot.keep_signed(result, known.from("ur3", MessageType::information, result), known.step(out)));
    return out;
  }

  KnownRun known;
  LostJournal lost;
  RobotHandler robot{known.self, known.runs, known.executor, lost, known.journal};
  RobotSchedule schedule;
  ConditionHandler conditions{known.self, known.runs, known.journal};
  BatonHandler batons{known.self, known.runs, known.executor, known.lookup, known.journal};
  RefusalHandler refusals{known.self, known.runs, known.executor, conditions, batons, known.journal};
};

}  // namespace

TEST_CASE("a task begins with its start record, once the robot is ready") {
  Working working;
  CHECK(sent<Execute>(working.at_end_of_step()).empty());
  working.tell_online();
  const Outbox out = working.at_end_of_step();
  REQUIRE(out.journal.size() == 1);
  CHECK(std::any_cast<JournalStart>(out.journal[0].record).instance == 5);
  CHECK(sent<Execute>(out).size() == 1);
  CHECK(targets<TaskProgress>(out) == Names{"cloud", "cloud2"});
  CHECK(sent<Execute>(working.at_end_of_step()).empty());
}

TEST_CASE("a cloud node that was away when an attempt began is told how far it is, by what it sends next") {
  Working working;
  const Execute begun = working.start();
  Baton baton;
  baton.run = kKnownRun;
  baton.digest = working.known.run().definition().start().digest;
  baton.epoch = 1;
  baton.final_tasks.bytes = baton.skipped_tasks.bytes = to_bitmap({false, false});
  baton.tasks = {0};
  const auto told = [&](const std::string& cloud, const auto& message) {
    const Outbox out = working.known.send(working.batons, cloud, message);
    const auto progress = sent<TaskProgress>(out);
    if (progress.empty()) return std::string();
    CHECK(targets<TaskProgress>(out) == Names{cloud});
    return std::string(name_of(progress.at(0).state));
  };
  CHECK(told("cloud2", BatonJournaled{kKnownRun, 1, {0}}) == "INITIALIZING");
  ExecutionState running;
  running.key = begun.key;
  running.instance = 5;
  running.state = "running";
  working.known.send(working.robot, "ur3", running, MessageType::information);
  CHECK(told("cloud", baton).empty());  // it passes the task in its turn
  working.known.pass(30);
  CHECK(told("cloud", baton) == "RUNNING");
  CHECK(told("drone", baton).empty());
  working.tell_outcome(TaskOutcome::finished);
  CHECK(told("cloud", baton).empty());
}

TEST_CASE("an outcome is signed, journaled, and told to the mode-adapter") {
  Working working;
  working.start();
  const SignedRecord result = signed_by(working.known.signers, "ur3", working.tell_outcome(TaskOutcome::finished));
  Outbox out;
  const Inbound from = working.known.from("ur3", MessageType::information, result);
  CHECK_FALSE(working.robot.keep_signed(working.known.end(), from, working.known.step(out)));
  CHECK(working.robot.keep_signed(result, from, working.known.step(out)));
  CHECK(working.known.run().results().has_final(0));
  CHECK(sent<OutcomeJournaled>(out).size() == 1);
  const Outbox again = working.tell_outcome(TaskOutcome::finished);
  CHECK(again.counts == Names{"late.outcome"});
  CHECK(sent<OutcomeJournaled>(again).size() == 1);
}

TEST_CASE("only the own mode-adapter speaks of the robot") {
  Working working;
  CHECK_FALSE(nacks(working.known.send(working.robot, "drone", AdapterState{}, MessageType::command)).empty());
  CHECK_FALSE(working.known.executor.adapter().has_value());
}

TEST_CASE("what a run allows its attempt follows its orders") {
  Working working;
  working.start();
  const auto permit = [&] {
    working.at_end_of_step();
    return working.known.executor.attempt()->permit;
  };
  CHECK(permit() == Permit::go);
  REQUIRE(working.known.run().apply(JournalPause{working.known.pause(1, true), false}).ok());
  CHECK(permit() == Permit::hold);
  working.known.run().work().withheld().give_back({0});
  CHECK(permit() == Permit::give_back);
  REQUIRE(working.known.run().apply(JournalAbort{working.known.abort(), false}).ok());
  CHECK(permit() == Permit::cancel);
}

TEST_CASE("an attempt whose start record was found is taken up, not begun anew") {
  Working working;
  JournalStart start;
  start.key = {kKnownRun, "task-0", 1, 1};
  start.instance = 5;
  REQUIRE(working.known.run().apply(start).ok());
  working.tell_online();
  CHECK(sent<Execute>(working.at_end_of_step()).empty());
  CHECK(working.known.executor.runs(kKnownRun));
}

TEST_CASE("a run that knows other keys of this node loses its attempt, and keeps the robot from no other run") {
  Working working(chain({"ur3", "ur3"}));
  working.start();
  const Outbox given_up = working.sign_with_new_keys(working.tell_outcome(TaskOutcome::finished));
  CHECK(given_up.journal.empty());
  CHECK(sent<OutcomeJournaled>(given_up).size() == 1);
  REQUIRE(given_up.logs.size() == 1);
  CHECK(given_up.logs[0].event == "own_keys_changed");
  CHECK_FALSE(working.known.executor.attempt().has_value());
  // It is not taken up again, and nothing of the run begins.
  working.tell_online();
  const Outbox after = working.at_end_of_step();
  CHECK(after.sends.empty());
  CHECK(after.logs.empty());
  CHECK_FALSE(working.known.executor.attempt().has_value());
  CHECK(working.known.run().orders().is_open());
  // A run that was made since goes on.
  const std::string id(32, 'b');
  auto later = working.known.runs.open(
      working.known.signers.make_start(chain({"ur3"}), "cloud", working.known.now.utc, seconds(3600), id));
  REQUIRE(later.ok());
  working.known.runs.add(std::move(*later));
  const auto commands = sent<Execute>(working.at_end_of_step());
  REQUIRE(commands.size() == 1);
  CHECK(commands.front().key.run == id);
}

TEST_CASE("a node with new keys begins nothing in a run that knows its old ones, also what its journal has begun") {
  Working working(chain({"ur3", "ur3"}), Bytes(32, 'n'));
  JournalStart start;
  start.key = {kKnownRun, "task-0", 1, 1};
  start.epoch = 1;
  start.instance = 5;
  REQUIRE(working.known.run().apply(start).ok());
  working.schedule.resume_attempt();
  REQUIRE(working.known.executor.runs(kKnownRun));
  working.tell_online();
  const Outbox asks = working.at_end_of_step();
  CHECK(sent<ExecutionQuery>(asks).size() == 1);
  CHECK(asks.logs.size() == 1);
  // It may have ended before the restart, and the mode-adapter has forgotten it.
  ExecutionState unknown;
  unknown.key = start.key;
  unknown.instance = 5;
  unknown.state = "unknown";
  const Outbox ended = working.known.send(working.robot, "ur3", unknown, MessageType::information);
  CHECK(sent<Execute>(ended).empty());
  CHECK(working.sign_with_new_keys(ended).logs.empty());
  working.tell_online();
  const Outbox after = working.at_end_of_step();
  CHECK(after.sends.empty());
  CHECK(after.journal.empty());
  CHECK_FALSE(working.known.executor.attempt().has_value());
}

TEST_CASE("an outcome stays with the mode-adapter as long as its attempt has been begun and is not taken up yet") {
  Working working(chain({"ur3", "ur3"}));
  JournalStart old;
  old.key = {kKnownRun, "task-0", 1, 1};
  old.epoch = 1;
  old.instance = 5;
  REQUIRE(working.known.run().apply(old).ok());
  // What got other keys since has left its start record; a younger run's attempt was under way when this node ended.
  const std::string id(32, 'b');
  auto later = working.known.runs.open(
      working.known.signers.make_start(chain({"ur3"}), "cloud", working.known.now.utc + seconds(1), seconds(3600), id));
  REQUIRE(later.ok());
  Run& younger = working.known.runs.add(std::move(*later));
  JournalStart start = old;
  start.key.run = id;
  REQUIRE(younger.apply(start).ok());
  working.schedule.resume_attempt();
  REQUIRE(working.known.executor.runs(kKnownRun));
  Outcome outcome;
  outcome.key = start.key;
  outcome.instance = 5;
  outcome.outcome = TaskOutcome::finished;
  const auto tell = [&] { return working.known.send(working.robot, "ur3", outcome, MessageType::information); };
  const Outbox early = tell();
  // Who is told that it is journaled forgets it, and would be ordered to do the task again.
  CHECK(sent<OutcomeJournaled>(early).empty());
  CHECK(early.logs.empty());
  working.sign_with_new_keys(working.tell_outcome(TaskOutcome::finished));
  working.schedule.resume_attempt();
  REQUIRE(working.known.executor.runs(id));
  CHECK(sent<SignRequest>(tell()).size() == 1);
  // What the other run's attempt has ended with is of no use any more.
  CHECK(sent<OutcomeJournaled>(working.tell_outcome(TaskOutcome::finished)).size() == 1);
}

TEST_CASE("a run that knows other keys of this node has no task begun at all") {
  Working working(chain({"ur3"}), Bytes(32, 'n'));
  working.tell_online();
  CHECK(working.at_end_of_step().sends.empty());
  Working same;
  const Bytes key = same.known.run().members().find("ur3")->identity_key.bytes;
  RobotSchedule schedule(same.known.runs, same.known.executor, same.lost, key);
  same.tell_online();
  Outbox out;
  schedule.update_due(same.known.run(), same.known.step(out));
  schedule.start_next(same.known.step(out));
  CHECK(sent<Execute>(out).size() == 1);
}

TEST_CASE("a run of 1000 tasks with 5 kB each finishes: data is left out early enough for all that end without") {
  for (const std::size_t most_bytes : {RunStore::kMostBytes, std::size_t{1} << 20U}) {
    Working working(chain(std::vector<std::string>(1000, "ur3")), {}, most_bytes);
    working.tell_online();
    int ended = 0;
    for (; ended < 1000; ++ended) {
      const auto commands = sent<Execute>(working.at_end_of_step());
      REQUIRE(commands.size() == 1);
      Outcome outcome;
      outcome.key = commands.front().key;
      outcome.instance = 5;
      outcome.outcome = TaskOutcome::finished;
      outcome.data = std::string(5000, 'x');
      const Outbox request = working.known.send(working.robot, "ur3", outcome, MessageType::information);
      const SignedRecord result = signed_by(working.known.signers, "ur3", request);
      // As its judge takes it.
      if (!working.known.runs.received_result(working.known.run(), result).ok()) break;
      Outbox out;
      working.robot.keep_signed(result, working.known.from("ur3", MessageType::information, result),
                                working.known.step(out));
    }
    CHECK(ended == 1000);
    CHECK(working.known.run().facts().all_final());
  }
}

TEST_CASE("a task that is due for too long fails, and says what it waited for") {
  Scenario scenario = chain({"ur3"});
  scenario.tasks[0].start_within_s = 5;
  Working working(scenario);
  working.at_end_of_step();
  CHECK(RobotSchedule::next_late(working.known.run(), working.known.now.mono) == working.known.now.mono + seconds(5));
  working.known.pass(5);
  working.at_end_of_step();
  CHECK(working.known.run().work().withheld().failing().at(0) ==
        "it did not begin within 5 s: its mode-adapter has not reported yet");
}

TEST_CASE("a refusal that passes keeps the attempt; one that does not ends it") {
  Working passing;
  passing.start();
  passing.refuse("busy", "execute");
  CHECK(passing.known.executor.is_refused());
  Working failing;
  failing.start();
  CHECK(sent<SignRequest>(failing.refuse("bad_value", "execute")).size() == 1);
}

TEST_CASE("what a peer refuses as expired is owed on, unless the run is over here, too") {
  Working working;
  working.known.finish("task-0");
  const Nack nack{"expired", "results", "cloud", "the run is over", "", kKnownRun};
  const PendingDeliveries& pending = working.known.run().deliveries().pending();
  working.known.send(working.refusals, "cloud", nack, MessageType::information);
  CHECK(pending.owes(DeliveryKind::results, "cloud"));
  REQUIRE(working.known.run().apply(JournalEnd{working.known.end()}).ok());
  working.known.send(working.refusals, "cloud", nack, MessageType::information);
  CHECK_FALSE(pending.owes(DeliveryKind::results, "cloud"));
}

TEST_CASE(
    "a journal that was lost keeps the robot from beginning until it is out of use, and the decider has no result") {
  Working working;
  working.lost.restore({1, false});
  working.tell_online();
  CHECK(sent<Execute>(working.at_end_of_step()).empty());
  const Outbox out = working.known.send(working.robot, "ur3", Ack{"out_of_use", ""}, MessageType::information);
  CHECK(out.journal.size() == 1);
  CHECK(sent<Execute>(working.at_end_of_step()).empty());
  AwaitedRecords& awaited = working.known.run().work().awaited();
  const std::string& judge = working.known.run().definition().rule().judge();
  CHECK(awaited.take_due_results(working.known.now.mono).at(judge) == std::vector<TaskIndex>{0});
  awaited.settle_without_result(judge, working.known.now.mono);
  CHECK(sent<Execute>(working.at_end_of_step()).size() == 1);
}

TEST_CASE("a run that was created after the journal was lost hides nothing, but for clocks that are apart or not set") {
  constexpr std::int64_t kSecond = 1'000'000'000;
  constexpr std::int64_t kLost = 1'800'000'000 * kSecond;
  constexpr UtcTime kNow{kLost + 3600 * kSecond};
  LostJournal lost;
  CHECK_FALSE(lost.may_have_held(0, kNow));
  lost.restore({kLost, true});
  CHECK(lost.may_have_held(kLost - kSecond, kNow));
  CHECK(lost.may_have_held(kLost + 599 * kSecond, kNow));
  CHECK_FALSE(lost.may_have_held(kLost + 601 * kSecond, kNow));
  // It is of the future: this clock is behind.
  CHECK(lost.may_have_held(kNow.ns + 601 * kSecond, kNow));
  lost.restore({kLost, false});
  CHECK(lost.may_have_held(kLost + 601 * kSecond, kNow));
  lost.restore({3600 * kSecond, true});
  CHECK(lost.may_have_held(kLost, kNow));
}

TEST_CASE("the time of the loss is taken from a clock that has kept pace for 10 min, and anew if it is set later") {
  constexpr std::int64_t kDay = 86'400'000'000'000;
  LostJournal lost;
  lost.restore({0, false});
  Outbox out;
  lost.close(out);
  // As a PC without a clock: its date is old, though it could be one.
  UtcTime utc{1'700'000'000'000'000'000};
  const std::int64_t long_after = utc.ns + 100 * kDay;
  const UtcTime later{long_after + kDay};
  const auto watch = [&](double mono_s, UtcTime now) {
    out.clear();
    lost.watch_clock({at(mono_s).mono, now}, out);
    return out.journal.empty() ? -1 : std::any_cast<JournalLost>(out.journal[0].record).time;
  };
  CHECK(watch(0, utc) == -1);
  CHECK(lost.next() == at(600).mono);
  CHECK(watch(599, utc + seconds(599)) == -1);
  CHECK(lost.may_have_held(long_after, later));
  // It is set: from here on it counts.
  CHECK(watch(600, later) == -1);
  CHECK(watch(1199, later + seconds(599)) == -1);
  CHECK(watch(1200, later + seconds(600)) == later.ns + seconds(600).count());
  CHECK(lost.may_have_held(long_after, later + seconds(600)));
  CHECK_FALSE(lost.may_have_held(later.ns + kDay, UtcTime{later.ns + kDay}));
  CHECK_FALSE(lost.next().has_value());
  // It was wrong for longer than that.
  CHECK(watch(1201, UtcTime{later.ns + 3 * kDay}) == 0);
  CHECK(lost.may_have_held(later.ns + kDay, UtcTime{later.ns + 3 * kDay}));
  CHECK(watch(1801, UtcTime{later.ns + 3 * kDay} + seconds(600)) > later.ns + 3 * kDay);
}
