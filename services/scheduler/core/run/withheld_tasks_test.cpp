#include "services/scheduler/core/run/withheld_tasks.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::scheduler;

TEST_CASE("a task that is asked back or cannot begin is withheld until a decision rules on it") {
  WithheldTasks tasks;
  tasks.give_back({1, 2});
  tasks.fail(3, "no value for 'box'");
  CHECK(tasks.is_asked_back(1));
  CHECK_FALSE(tasks.is_failing(1));
  CHECK(tasks.failing().at(3) == "no value for 'box'");
  for (const TaskIndex task : std::vector<TaskIndex>{1, 2, 3}) CHECK(tasks.contains(task));
  tasks.drop(1);
  tasks.drop(3);
  CHECK(tasks.asked_back() == std::set<TaskIndex>{2});
  CHECK(tasks.failing().empty());
}

TEST_CASE("a task that is asked back is to stop once that was asked for, until a decision rules on it") {
  WithheldTasks tasks;
  tasks.give_back({1, 2});
  tasks.give_back({1}, true);
  tasks.give_back({1});
  CHECK(tasks.is_to_stop(1));
  CHECK_FALSE(tasks.is_to_stop(2));
  tasks.drop(1);
  CHECK_FALSE(tasks.is_to_stop(1));
}

TEST_CASE("a task whose result is known fails no more, but is still asked back") {
  WithheldTasks tasks;
  tasks.give_back({1});
  tasks.fail(1, "late");
  tasks.drop_failing(1);
  CHECK_FALSE(tasks.is_failing(1));
  CHECK(tasks.contains(1));
}
