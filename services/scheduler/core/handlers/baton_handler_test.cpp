#include "services/scheduler/core/handlers/baton_handler.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Names = std::vector<std::string>;

/// ur3 has the second of three tasks.
struct Passing {
  Baton baton() {
    Baton out;
    out.run = kKnownRun;
    out.digest = known.run().definition().start().digest;
    out.epoch = known.run().epochs().current();
    out.final_tasks.bytes = to_bitmap({true, false, false});
    out.skipped_tasks.bytes = to_bitmap({false, false, false});
    out.tasks = {1};
    return out;
  }

  KnownRun known{chain({"drone", "ur3", "pioneer"})};
  BatonHandler handler{known.self, known.runs, known.executor, known.lookup, known.journal};
};

}  // namespace

TEST_CASE("a baton's results are journaled before it is confirmed") {
  Passing passing;
  Baton baton = passing.baton();
  baton.results = {passing.known.result("task-0", "drone", TaskOutcome::finished)};
  const Outbox out = passing.known.send(passing.handler, "drone", baton);
  REQUIRE(out.journal.size() == 1);
  CHECK(std::any_cast<JournalResult>(&out.journal[0].record) != nullptr);
  CHECK(targets<BatonJournaled>(out) == Names{"drone"});
  CHECK(passing.known.run().open_tasks().startable() == std::vector<TaskIndex>{1});
  CHECK_FALSE(passing.known.run().work().awaited().needs_results());
}

TEST_CASE("results that a baton only speaks of are asked of its giver") {
  Passing passing;
  passing.known.send(passing.handler, "drone", passing.baton());
  CHECK(passing.known.run().known_final() == std::vector<bool>{true, false, false});
  CHECK(passing.known.run().work().awaited().take_due_results(passing.known.now.mono).at("drone") ==
        std::vector<TaskIndex>{0});
}

TEST_CASE("a baton that says nothing new changes nothing that watchers are told of, but is confirmed") {
  Passing passing;
  const std::uint64_t before = passing.known.run().version();
  passing.known.send(passing.handler, "drone", passing.baton());
  const std::uint64_t after = passing.known.run().version();
  CHECK(after == before + 1);
  for (int i = 0; i < 100; ++i) {
    const Outbox out = passing.known.send(passing.handler, "drone", passing.baton());
    CHECK(targets<BatonJournaled>(out) == Names{"drone"});
  }
  CHECK(passing.known.run().version() == after);
}

TEST_CASE("where decisions come from, a baton's word on others' tasks ends none of them") {
  KnownRun known{chain({"drone", "ur3", "pioneer"}), "cloud"};
  BatonHandler handler{known.self, known.runs, known.executor, known.lookup, known.journal};
  Baton baton;
  baton.run = kKnownRun;
  baton.digest = known.run().definition().start().digest;
  baton.epoch = 1;
  baton.final_tasks.bytes = to_bitmap({true, true, true});
  baton.skipped_tasks.bytes = to_bitmap({false, false, false});
  known.send(handler, "drone", baton);
  CHECK(known.run().known_final() == std::vector<bool>{false, false, false});
  known.finish("task-0");
  CHECK(known.run().known_final() == std::vector<bool>{true, false, false});
}

TEST_CASE("a baton with a bad result, or for another's task, leaves no trace") {
  Passing passing;
  Baton bad = passing.baton();
  bad.results = {passing.known.result("task-0", "pioneer", TaskOutcome::finished)};
  Baton foreign = passing.baton();
  foreign.tasks = {2};
  for (const Baton& baton : {bad, foreign}) {
    const Outbox out = passing.known.send(passing.handler, "drone", baton);
    CHECK(nacks(out).size() == 1);
    CHECK(out.journal.empty());
    CHECK(passing.known.run().known_final() == std::vector<bool>{false, false, false});
  }
}

TEST_CASE("an older epoch is refused; of a later one the giver is asked for the decisions") {
  Passing passing;
  Baton later = passing.baton();
  later.epoch = 2;
  const Outbox out = passing.known.send(passing.handler, "drone", later);
  CHECK(targets<NeedDefinition>(out) == Names{"drone"});
  const Baton older = passing.baton();
  passing.known.decide({{"task-2", Ruling::move, "ur3", 2, Evidence::word}});
  CHECK(nacks(passing.known.send(passing.handler, "drone", older)) == Names{"conflict"});
}

TEST_CASE("who has journaled a baton is owed it no more, if it is of this epoch") {
  Passing passing;
  passing.known.finish("task-0");
  passing.known.finish("task-1");
  REQUIRE(passing.known.run().deliveries().pending().owes_baton(2));
  CHECK(passing.known.send(passing.handler, "pioneer", BatonJournaled{kKnownRun, 2, {2}}).journal.empty());
  const Outbox out = passing.known.send(passing.handler, "pioneer", BatonJournaled{kKnownRun, 1, {2}});
  CHECK(out.journal.size() == 1);
  CHECK_FALSE(passing.known.run().deliveries().pending().owes_baton(2));
}

TEST_CASE("who refuses a baton that is owed may know a later epoch, and is asked; a full one is remembered") {
  Passing passing;
  passing.known.finish("task-0");
  passing.known.finish("task-1");
  const auto refused = [&](const char* code, const std::string& by) {
    Outbox out;
    const Nack nack{code, "baton", "", "no place", "", kKnownRun};
    passing.handler.on_refusal(nack, passing.known.from(by, MessageType::information, nack), passing.known.step(out));
    return targets<NeedDefinition>(out);
  };
  CHECK(refused("conflict", "pioneer") == Names{"pioneer"});
  CHECK(refused("conflict", "drone").empty());
  CHECK(refused("queue_full", "pioneer").empty());
  CHECK(passing.known.run().deliveries().refusals().at("pioneer") == "no place");
}
