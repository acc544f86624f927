#include "services/scheduler/core/run/open_tasks.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/condition_story.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

using Tasks = std::vector<TaskIndex>;

TEST_CASE("a node can start its own task once all before it is final, and not one that has begun") {
  KnownRun known(chain({"drone", "ur3"}));
  CHECK(known.run().open_tasks().startable().empty());
  known.finish("task-0");
  CHECK(known.run().open_tasks().startable() == Tasks{1});
  JournalStart start;
  start.key = {kKnownRun, "task-1", 1, 1};
  REQUIRE(known.run().apply(start).ok());
  CHECK(known.run().open_tasks().startable().empty());
}

TEST_CASE("a task that is asked back is released, not started") {
  KnownRun known(chain({"ur3"}));
  known.run().work().withheld().give_back({0});
  CHECK(known.run().open_tasks().startable().empty());
  CHECK(known.run().open_tasks().releasable() == Tasks{0});
  known.add(known.result("task-0", "ur3", TaskOutcome::released));
  CHECK(known.run().open_tasks().releasable().empty());
}

TEST_CASE("what each step asks follows each change: of facts, of what is withheld, of the epoch") {
  KnownRun known(chain({"ur3", "drone"}));
  const OpenTasks& open = known.run().open_tasks();
  CHECK(open.startable() == Tasks{0});
  known.run().work().withheld().fail(0, "no robot");
  CHECK(open.startable().empty());
  known.run().work().withheld().drop_failing(0);
  CHECK(open.startable() == Tasks{0});
  known.add(known.result("task-0", "ur3", TaskOutcome::failed));
  CHECK(open.own_has_failed());
  CHECK(open.startable().empty());
  known.decide({{"task-0", Ruling::retry, "ur3", 2, Evidence::result}});
  CHECK(open.startable() == Tasks{0});
  CHECK_FALSE(open.own_are_final());
  known.add(known.result("task-0", "ur3", TaskOutcome::finished, 2));
  CHECK(open.own_are_final());
  CHECK_FALSE(open.own_has_failed());
}

TEST_CASE("conditions are chosen on where the first predecessor's actor is; the judge knows who has to") {
  KnownRun chooser(left_or_right(), "ridgeback");
  KnownRun judge(left_or_right(), "cloud");
  CHECK(chooser.run().open_tasks().to_choose().empty());
  for (KnownRun* known : {&chooser, &judge}) known->finish("bring");
  CHECK(chooser.run().open_tasks().to_choose() == Tasks{1, 2});
  CHECK(judge.run().open_tasks().to_choose().empty());
  CHECK(judge.run().open_tasks().choosing_elsewhere() == Tasks{1, 2});
}

TEST_CASE("what follows a skipped task is skippable at its own robot") {
  KnownRun known(left_or_right("drone", "ur3"));
  known.finish("bring");
  REQUIRE(known.run().apply(JournalChoice{known.choice("ridgeback", "right", 15)}).ok());
  CHECK(known.run().open_tasks().skippable() == Tasks{2});
}

TEST_CASE("due is what nothing stands before: for a robot its own tasks, for the judge all") {
  KnownRun robot(chain({"drone", "ur3"}));
  KnownRun judge(chain({"drone", "ur3"}), "cloud");
  CHECK(robot.run().open_tasks().due().empty());
  CHECK(judge.run().open_tasks().due() == Tasks{0});
  judge.run().reports().note_progress(0, TaskState::running);
  CHECK(judge.run().open_tasks().due().empty());
}

TEST_CASE("results that are said to be final and are not held are missed") {
  KnownRun known(chain({"drone", "ur3", "pioneer"}));
  CHECK(known.run().open_tasks().missing_results({true, false, false}) == Tasks{0});
  CHECK(known.run().open_tasks().missing_results({false, false, false}).empty());
  known.finish("task-0");
  CHECK(known.run().open_tasks().missing_results({true, false, false}).empty());
}
