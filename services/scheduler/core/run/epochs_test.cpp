#include "services/scheduler/core/run/epochs.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/condition_story.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

TEST_CASE("in the first epoch every task is whose the start says") {
  const KnownRun known(chain({"drone", "ur3", "drone"}));
  const Epochs& epochs = known.run().epochs();
  CHECK(epochs.current() == 1);
  CHECK(epochs.robot_of(0) == "drone");
  CHECK(epochs.own_tasks() == std::vector<TaskIndex>{1});
  CHECK_FALSE(epochs.is_ruled(1));
  CHECK_FALSE(epochs.is_void(1, 1));
}

TEST_CASE("a decision moves a task, and makes earlier attempts void; who had it in which epoch stays known") {
  KnownRun known(chain({"drone", "ur3", "drone"}));
  known.decide({{"task-0", Ruling::move, "ur3", 3, Evidence::result}});
  known.decide({{"task-0", Ruling::move, "pioneer", 5, Evidence::word}});
  const Epochs& epochs = known.run().epochs();
  CHECK(epochs.current() == 3);
  CHECK(epochs.robot_in(0, 1) == "drone");
  CHECK(epochs.robot_in(0, 2) == "ur3");
  CHECK(epochs.robot_before(0) == "ur3");
  CHECK(epochs.robot_of(0) == "pioneer");
  CHECK(epochs.is_void(0, 4));
  CHECK_FALSE(epochs.is_void(0, 5));
  CHECK(epochs.is_vouched_still("ur3"));
  CHECK_FALSE(epochs.is_vouched_still("drone"));
  CHECK(epochs.last_decision_on(0).epoch == 3);
  CHECK(epochs.is_of_epoch({1, 2}, 1));
  CHECK_FALSE(epochs.is_of_epoch({0, 1}, 2));
}

TEST_CASE("a task that a decision skips goes to the decider's node; one without a robot is there from the start on") {
  Scenario scenario = chain({"drone", "ur3"});
  KnownRun known(scenario, "cloud");
  known.decide({{"task-1", Ruling::skip, "cloud", 2, Evidence::word}});
  CHECK(known.run().epochs().is_skipped(1));
  CHECK_FALSE(known.run().epochs().is_unbound(1));
  CHECK(known.run().epochs().decides_here());
  CHECK(known.run().epochs().own_tasks() == std::vector<TaskIndex>{1});
}

TEST_CASE("a condition is evaluated by the actor of the task's first predecessor") {
  const KnownRun known(left_or_right(), "ridgeback");
  const Epochs& epochs = known.run().epochs();
  CHECK(epochs.chooser_of(1) == "ridgeback");
  CHECK(epochs.chooses_here(1));
  CHECK_FALSE(epochs.is_own(1));
  CHECK(epochs.concerned_tasks() == std::vector<TaskIndex>{0, 1, 2});
}
