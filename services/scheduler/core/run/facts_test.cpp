#include "services/scheduler/core/run/facts.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/condition_story.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

TEST_CASE("what a robot will try again by itself is no result that counts") {
  Scenario scenario = chain({"ur3"});
  scenario.tasks[0].retries = 1;
  KnownRun known(scenario);
  known.add(known.result("task-0", "ur3", TaskOutcome::retriable));
  const Facts& facts = known.run().facts();
  CHECK(facts.current(0) == nullptr);
  CHECK(facts.next_attempt(0) == 2);
  CHECK(facts.problems().empty());
  known.add(known.result("task-0", "ur3", TaskOutcome::retriable, 2));
  REQUIRE(facts.current(0) != nullptr);
  CHECK(facts.problems() == std::vector<TaskIndex>{0});
}

TEST_CASE("a decision makes what has failed void; what was finished stays") {
  KnownRun known(chain({"ur3", "drone"}));
  known.finish("task-0");
  known.add(known.result("task-1", "drone", TaskOutcome::failed));
  known.decide({{"task-1", Ruling::move, "ur3", 2, Evidence::result}});
  const Facts& facts = known.run().facts();
  CHECK(facts.current(0) != nullptr);
  CHECK(facts.current(1) == nullptr);
  CHECK(facts.next_attempt(1) == 2);
  CHECK_FALSE(facts.all_final());
}

TEST_CASE("a start record without a result is open until there is one") {
  KnownRun known(chain({"ur3"}));
  JournalStart start;
  start.key = {kKnownRun, "task-0", 1, 1};
  REQUIRE(known.run().apply(start).ok());
  REQUIRE(known.run().facts().open_start() != nullptr);
  CHECK(known.run().facts().has_begun(0));
  known.finish("task-0");
  CHECK(known.run().facts().open_start() == nullptr);
  CHECK(known.run().facts().all_final());
}

TEST_CASE("a choice decides which branch goes; the first one holds") {
  KnownRun known(left_or_right(), "ridgeback");
  known.finish("bring");
  const Facts& facts = known.run().facts();
  CHECK(facts.fate_of(1) == Fate::undecided);
  for (const double degrees : {15.0, 25.0}) {
    REQUIRE(known.run().apply(JournalChoice{known.choice("ridgeback", "left", degrees)}).ok());
  }
  CHECK(facts.fate_of(1) == Fate::goes);
  REQUIRE(known.run().apply(JournalChoice{known.choice("ridgeback", "right", 15)}).ok());
  CHECK(facts.fate_of(2) == Fate::skipped);
}

TEST_CASE("what follows nothing but SKIPPED tasks is SKIPPED") {
  KnownRun known(chain({"ur3", "drone"}));
  known.add(known.result("task-0", "ur3", TaskOutcome::skipped));
  CHECK(known.run().facts().all_before_skipped(1));
  CHECK(known.run().facts().fate_of(1) == Fate::skipped);
  CHECK_FALSE(known.run().facts().all_before_skipped(0));
}

TEST_CASE("who has done what was SKIPPED takes along nothing any more; what is final stays counted once") {
  Scenario scenario = chain({"ur3", "drone", "pioneer"});
  scenario.tasks[1].after = {};
  scenario.tasks[2].after = {0, 1};
  KnownRun known(scenario, "pioneer");
  const Facts& facts = known.run().facts();
  known.add(known.result("task-0", "ur3", TaskOutcome::skipped));
  CHECK_FALSE(facts.all_before_final(2));
  known.add(known.result("task-1", "drone", TaskOutcome::skipped));
  CHECK(facts.all_before_final(2));
  CHECK(facts.fate_of(2) == Fate::skipped);
  CHECK(known.run().open_tasks().startable().empty());
  known.add(known.result("task-0", "ur3", TaskOutcome::finished));
  CHECK(facts.all_before_final(2));
  CHECK(facts.fate_of(2) == Fate::goes);
  CHECK(known.run().open_tasks().startable() == std::vector<TaskIndex>{2});
  CHECK_FALSE(facts.all_final());
  known.finish("task-2");
  CHECK(facts.all_final());
}

TEST_CASE("a failure that ends the run is no problem that a person solves") {
  Scenario scenario = chain({"ur3", "drone"});
  scenario.tasks[0].on_failure = OnFailure::abort;
  KnownRun known(scenario);
  known.add(known.result("task-0", "ur3", TaskOutcome::failed));
  CHECK(known.run().facts().problems().empty());
  CHECK(known.run().facts().ending_task() == TaskIndex{0});
}

TEST_CASE("the pause before a retry doubles") {
  Scenario scenario = chain({"ur3"});
  scenario.tasks[0].retries = 5;
  scenario.tasks[0].retry_after_s = 10;
  KnownRun known(scenario);
  for (const double expected : {10.0, 20.0, 40.0, 60.0}) {
    known.add(known.result("task-0", "ur3", TaskOutcome::retriable, known.run().facts().next_attempt(0)));
    CHECK(to_seconds(known.run().facts().retry_pause(0)) == doctest::Approx(expected));
  }
}

TEST_CASE("a pause of over a minute before a retry stays as long as the scenario says") {
  Scenario scenario = chain({"ur3"});
  scenario.tasks[0].retries = 5;
  scenario.tasks[0].retry_after_s = 300;
  KnownRun known(scenario);
  for (int i = 0; i < 3; ++i) {
    known.add(known.result("task-0", "ur3", TaskOutcome::retriable, known.run().facts().next_attempt(0)));
    CHECK(to_seconds(known.run().facts().retry_pause(0)) == doctest::Approx(300));
  }
}
