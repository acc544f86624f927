#include "services/scheduler/core/run/deliveries.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

/// What is owed now, as "baton ur3 [1 2]".
std::vector<std::string> owed(KnownRun& known) {
  std::vector<std::string> out;
  known.run().deliveries().pending().restart();
  for (const PendingDelivery& one : known.run().deliveries().pending().take_due(known.now.mono)) {
    std::string text = std::string(name_of(one.kind)) + " " + one.to + " [";
    for (const TaskIndex task : one.tasks) text += (text.ends_with("[") ? "" : " ") + std::to_string(task);
    out.push_back(text + "]");
  }
  return out;
}

using Owed = std::vector<std::string>;

}  // namespace

TEST_CASE("the submitter's node owes the first tasks to their actors, and the run to the other cloud") {
  KnownRun known(nine_tasks(), "cloud");
  CHECK(owed(known).empty());
  REQUIRE(known.run().apply(JournalRun{known.start, true}).ok());
  CHECK(owed(known) == Owed{"baton ridgeback [0]", "baton cloud2 []"});
}

TEST_CASE("the actor of a final task owes the result to every cloud, and the baton to the next actor") {
  KnownRun known(chain({"ur3", "drone"}));
  known.finish("task-0");
  CHECK(owed(known) == Owed{"results cloud [0]", "results cloud2 [0]", "baton drone [1]"});
  CHECK(known.run().deliveries().settle(DeliveryKind::results, "cloud", {0}));
  CHECK(owed(known) == Owed{"results cloud2 [0]", "baton drone [1]"});
}

TEST_CASE("a join is passed on once all its predecessors of this node are final") {
  Scenario scenario = chain({"ur3", "ur3", "drone"});
  scenario.tasks[1].after = {};
  scenario.tasks[2].after = {0, 1};
  KnownRun known(scenario);
  known.finish("task-0");
  CHECK_FALSE(known.run().deliveries().pending().owes_baton(2));
  known.finish("task-1");
  CHECK(known.run().deliveries().pending().owes_baton(2));
}

TEST_CASE("a new epoch has its own batons, but for tasks that are final") {
  KnownRun known(chain({"ur3", "drone", "drone"}));
  known.finish("task-0");
  known.decide({{"task-1", Ruling::move, "pioneer", 2, Evidence::word}});
  CHECK(owed(known) == Owed{"results cloud [0]", "results cloud2 [0]", "baton pioneer [1]"});
}

TEST_CASE("a baton that was journaled where the task is now is not owed anew") {
  KnownRun known(chain({"ur3", "drone", "pioneer"}));
  known.finish("task-0");
  JournalDelivered fact;
  fact.run = kKnownRun;
  fact.to = "drone";
  fact.what = "baton";
  fact.tasks = {1};
  REQUIRE(known.run().apply(fact).ok());
  CHECK(known.run().deliveries().has_passed(1));
  known.decide({{"task-2", Ruling::move, "ridgeback", 2, Evidence::word}});
  CHECK_FALSE(known.run().deliveries().pending().owes_baton(1));
  known.decide({{"task-1", Ruling::move, "ridgeback", 2, Evidence::word}});
  CHECK_FALSE(known.run().deliveries().has_passed(1));
  CHECK(known.run().deliveries().pending().owes_baton(1));
}

TEST_CASE("the decider knows which tasks nobody has passed on") {
  KnownRun known(chain({"ur3", "drone"}), "cloud");
  CHECK(known.run().deliveries().unpassed().empty());
  known.finish("task-0");
  CHECK(known.run().deliveries().unpassed() == std::vector<TaskIndex>{1});
  KnownRun robot(chain({"ur3", "drone"}), "ur3");
  robot.finish("task-0");
  CHECK(robot.run().deliveries().unpassed().empty());
}

TEST_CASE("whoever knows an order owes it to every other member; an abort takes the batons' place") {
  KnownRun known(chain({"ur3", "drone"}));
  known.finish("task-0");
  REQUIRE(known.run().apply(JournalAbort{known.abort(), false}).ok());
  CHECK(known.run().deliveries().pending().creditors(DeliveryKind::baton).empty());
  CHECK(known.run().deliveries().pending().creditors(DeliveryKind::abort).size() ==
        known.run().members().ids().size() - 1);
}
