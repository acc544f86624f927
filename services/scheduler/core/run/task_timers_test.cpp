#include "services/scheduler/core/run/task_timers.hpp"

#include <doctest/doctest.h>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::scheduler;

TEST_CASE("a task waits for its retry until that time has come") {
  TaskTimers timers;
  timers.retry_at(3, at(2).mono);
  CHECK(timers.waits(3));
  CHECK(timers.next() == at(2).mono);
  timers.drop_past_retries(at(1.9).mono);
  CHECK(timers.waits(3));
  timers.drop_past_retries(at(2).mono);
  CHECK_FALSE(timers.waits(3));
}

TEST_CASE("a task that stays due keeps the time since which it is") {
  TaskTimers timers;
  timers.set_due({1, 2}, at(0).mono);
  timers.set_due({3, 2}, at(5).mono);
  CHECK_FALSE(timers.is_due(1));
  CHECK(timers.due_since().at(2) == at(0).mono);
  CHECK(timers.due_since().at(3) == at(5).mono);
  CHECK(timers.is_late(2, 4, at(4).mono));
  CHECK_FALSE(timers.is_late(2, 4, at(3.9).mono));
  CHECK_FALSE(timers.is_late(2, 0, at(1000).mono));
  timers.drop_due_if([](TaskIndex task) { return task == 2; });
  CHECK_FALSE(timers.is_due(2));
}

TEST_CASE("a task that wants a robot keeps the time since which it does, until the run is held") {
  TaskTimers timers;
  timers.set_unbound({1, 2}, at(0).mono);
  timers.set_unbound({2}, at(5).mono);
  CHECK(timers.unbound_since() == TaskTimers::Times{{2, at(0).mono}});
  timers.drop_all_due();
  timers.set_unbound({2}, at(9).mono);
  CHECK(timers.unbound_since() == TaskTimers::Times{{2, at(9).mono}});
}

TEST_CASE("what is due is worked out once for each version of the facts") {
  TaskTimers timers;
  CHECK(timers.take_version(0));  // of a run that nothing has happened to
  CHECK_FALSE(timers.take_version(0));
  CHECK(timers.take_version(4));
  CHECK_FALSE(timers.take_version(4));
  CHECK(timers.take_version(5));
}

TEST_CASE("a pass that is due comes again later") {
  TaskTimers timers;
  timers.set_passes({1, 2}, at(30).mono);
  CHECK(timers.take_due_passes(at(29).mono, at(59).mono).empty());
  CHECK(timers.take_due_passes(at(30).mono, at(60).mono) == std::vector<TaskIndex>{1, 2});
  CHECK(timers.next() == at(60).mono);
}
