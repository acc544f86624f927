#include "services/scheduler/core/handlers/result_handler.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/core/delivery_sender.hpp"
#include "services/scheduler/test/condition_story.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Names = std::vector<std::string>;

struct Collecting {
  explicit Collecting(const std::string& self = "cloud") : known(chain({"drone", "ur3"}), self) {}
  SignedRecord finished(const std::string& task, const std::string& robot) {
    return known.result(task, robot, TaskOutcome::finished);
  }
  KnownRun known;
  ResultHandler handler{known.runs, known.lookup, known.journal};
};

/// ur3 has asked the cloud for task-0's result.
struct Asking : Collecting {
  Asking() : Collecting("ur3") {
    awaited().need_result(0, "cloud", "cloud");
    awaited().take_due_results(known.now.mono);
  }
  AwaitedRecords& awaited() { return known.run().work().awaited(); }
};

}  // namespace

TEST_CASE("results are journaled and confirmed by key; a bad one among them is refused, the others stay") {
  Collecting collecting;
  const Results body{kKnownRun, {collecting.finished("task-0", "drone"), collecting.finished("task-0", "ur3")}, {}};
  const Outbox out = collecting.known.send(collecting.handler, "drone", body);
  CHECK(out.journal.size() == 1);
  CHECK(nacks(out) == Names{"not_permitted"});
  const auto confirmed = sent<ResultsJournaled>(out);
  REQUIRE(confirmed.size() == 1);
  CHECK(confirmed[0].keys.size() == 1);
  CHECK(collecting.known.run().results().has_final(0));
}

TEST_CASE("an answer without a result says that its giver does not hold what it spoke of") {
  Collecting collecting("ur3");
  AwaitedRecords& awaited = collecting.known.run().work().awaited();
  const auto answer = [&](const std::string& giver, std::vector<SignedRecord> results) {
    const Results body{kKnownRun, std::move(results), {}};
    return collecting.known.send(collecting.handler, giver, body, MessageType::information, 5);
  };
  awaited.need_result(0, "drone", "cloud");
  awaited.take_due_results(collecting.known.now.mono);
  answer("cloud", {});
  CHECK(awaited.needs_results());
  answer("drone", {});
  CHECK_FALSE(awaited.needs_results());
  CHECK(awaited.has_answered("drone", 0));
}

TEST_CASE("an answer that cannot be used says nothing of what its giver holds; of a later epoch it is asked for that") {
  Asking collecting;
  AwaitedRecords& awaited = collecting.awaited();
  KnownRun there(chain({"drone", "ur3"}), "cloud");
  there.decide({{"task-0", Ruling::retry, "drone", 2, Evidence::result}});
  const Results later{kKnownRun, {there.result("task-0", "drone", TaskOutcome::finished, 2)}, {}};
  const Outbox out = collecting.known.send(collecting.handler, "cloud", later, MessageType::information, 5);
  CHECK(targets<NeedDefinition>(out) == Names{"cloud"});
  CHECK(awaited.needs_results());
  CHECK_FALSE(awaited.has_answered("cloud", 0));
  const Results wrong{kKnownRun, {collecting.finished("task-0", "ur3")}, {}};
  const Outbox none = collecting.known.send(collecting.handler, "cloud", wrong, MessageType::information, 5);
  CHECK(targets<NeedDefinition>(none).empty());
  CHECK_FALSE(awaited.has_answered("cloud", 0));
}

TEST_CASE("a result that is not final is all that its giver holds of the task") {
  Asking collecting;
  AwaitedRecords& awaited = collecting.awaited();
  const Results failed{kKnownRun, {collecting.known.result("task-0", "drone", TaskOutcome::failed)}, {}};
  collecting.known.send(collecting.handler, "cloud", failed, MessageType::information, 5);
  CHECK_FALSE(awaited.needs_results());
  CHECK(awaited.has_answered("cloud", 0));
}

TEST_CASE("a member that asks for results gets those that are held") {
  Collecting collecting;
  collecting.known.finish("task-0");
  const Outbox out =
      collecting.known.send(collecting.handler, "ur3", NeedResults{kKnownRun, {0, 1}}, MessageType::request);
  REQUIRE(sent<Results>(out).size() == 1);
  CHECK(sent<Results>(out)[0].results.size() == 1);
}

TEST_CASE("a member that asks gets the choice on a task, too, of which there is no result yet") {
  KnownRun known(Scenario{"choice", "", {when(task("fly", "drone", {}), Comparison::at_most, 20)}}, "drone");
  ResultHandler handler{known.runs, known.lookup, known.journal};
  REQUIRE(known.run().apply(JournalChoice{known.choice("drone", "fly", 19)}).ok());
  const auto answers = sent<Results>(known.send(handler, "cloud", NeedResults{kKnownRun, {0}}, MessageType::request));
  REQUIRE(answers.size() == 1);
  CHECK(answers[0].results.empty());
  CHECK(answers[0].choices.size() == 1);
}

TEST_CASE("a member that asks gets results first: an answer without any says that there is no other") {
  Scenario scenario{"choices", "", {}};
  for (std::size_t i = 0; i < kMaxTasks; ++i)
    scenario.tasks.push_back(when(task(("task-" + std::to_string(i)).c_str(), "drone", {}), Comparison::at_most, 20));
  KnownRun known(scenario, "drone");
  ResultHandler handler{known.runs, known.lookup, known.journal};
  for (std::size_t i = 0; i < kMaxTasks; ++i) {
    auto choice = *decode<Choice>(known.choice("drone", "task-" + std::to_string(i), 19).payload.bytes);
    choice.reading.text = std::string(1024, 'x');
    REQUIRE(known.run().apply(JournalChoice{known.signers.sign("drone", kSignedChoice, encode(choice))}).ok());
  }
  known.finish("task-" + std::to_string(kMaxTasks - 1));
  std::vector<TaskIndex> all;
  for (std::size_t i = 0; i < kMaxTasks; ++i) all.push_back(static_cast<TaskIndex>(i));
  const auto answers = sent<Results>(known.send(handler, "cloud", NeedResults{kKnownRun, all}, MessageType::request));
  REQUIRE(answers.size() == 1);
  REQUIRE(answers[0].choices.size() < kMaxTasks);
  CHECK(answers[0].results.size() == 1);
}

TEST_CASE("a member whose answer has no room for all choices has not told all") {
  KnownRun known(Scenario{"choice",
                          "",
                          {when(task("fly", "drone", {}), Comparison::at_most, 20),
                           when(task("land", "drone", {}), Comparison::at_most, 20)}},
                 "cloud");
  ResultHandler handler{known.runs, known.lookup, known.journal};
  REQUIRE(known.run().apply(JournalDelivered{kKnownRun, "cloud", std::string(kRecovers), {}, 1}).ok());
  known.run().recovery().note_decisions("drone");
  const auto answer = [&](std::vector<SignedRecord> choices) {
    known.send(handler, "drone", Results{kKnownRun, {}, std::move(choices)}, MessageType::information, 5);
    const std::vector<std::string> silent = known.run().silent_members();
    return std::ranges::find(silent, "drone") == silent.end();
  };
  CHECK_FALSE(answer({known.choice("drone", "fly", 19)}));
  const auto questions = known.run().recovery().take_due({"drone"}, 2, known.now.mono);
  REQUIRE(questions.size() == 1);
  CHECK(questions[0].tasks == std::vector<TaskIndex>{1});
  CHECK(answer({known.choice("drone", "land", 19)}));
}

TEST_CASE("what another node has journaled is owed no more, unless it was another attempt") {
  Collecting collecting("drone");
  collecting.known.finish("task-0");
  const auto confirm = [&](std::uint32_t attempt) {
    return collecting.known.send(collecting.handler, "cloud", ResultsJournaled{{{kKnownRun, "task-0", 1, attempt}}});
  };
  CHECK(confirm(2).journal.empty());
  CHECK(collecting.known.run().deliveries().pending().owes(DeliveryKind::results, "cloud"));
  CHECK(confirm(1).journal.size() == 1);
  CHECK_FALSE(collecting.known.run().deliveries().pending().owes(DeliveryKind::results, "cloud"));
}

TEST_CASE("of a task that was done twice both results are owed, whoever knows it") {
  for (const char* self : {"ur3", "conveyor"}) {
    CAPTURE(self);
    Collecting collecting(self);
    KnownRun& known = collecting.known;
    const SignedRecord late = collecting.finished("task-0", "drone");
    known.decide({{"task-0", Ruling::move, "ur3", 2, Evidence::word}});
    known.add(late);
    known.add(known.result("task-0", "ur3", TaskOutcome::finished, 2));
    Outbox out;
    send_due(known.run(), known.step(out));
    REQUIRE(targets<Results>(out) == Names{"cloud", "cloud2"});
    CHECK(sent<Results>(out)[0].results.size() == 2);
    const auto confirm = [&](std::vector<std::uint32_t> attempts) {
      ResultsJournaled body;
      for (const std::uint32_t attempt : attempts) body.keys.push_back({kKnownRun, "task-0", 1, attempt});
      return known.send(collecting.handler, "cloud", body).journal.size();
    };
    CHECK(confirm({1}) == 0);
    CHECK(confirm({2}) == 0);
    CHECK(known.run().deliveries().pending().owes(DeliveryKind::results, "cloud"));
    CHECK(confirm({1, 2}) == 1);
    CHECK_FALSE(known.run().deliveries().pending().owes(DeliveryKind::results, "cloud"));
  }
}

TEST_CASE("progress is shown of the task's robot alone, until its result comes") {
  Collecting collecting;
  const auto tell = [&](const std::string& robot) {
    const TaskProgress body{{kKnownRun, "task-0", 1, 1}, robot, TaskState::running, {}};
    return collecting.known.send(collecting.handler, robot, body);
  };
  CHECK(nacks(tell("ur3")) == Names{"not_permitted"});
  tell("drone");
  CHECK(collecting.known.run().reports().is_under_way(0));
  collecting.known.finish("task-0");
  CHECK(tell("drone").counts == Names{"late.task_progress"});
  CHECK_FALSE(collecting.known.run().reports().is_under_way(0));
}
