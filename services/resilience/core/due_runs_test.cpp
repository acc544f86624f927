#include "services/resilience/core/due_runs.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

using Runs = std::set<std::string>;

}  // namespace

TEST_CASE("a run that something was told of is due once, others are not") {
  DueRuns due;
  due.schedule("quiet", at(60).mono);
  CHECK(due.take(at(0).mono).empty());
  due.notify("told");
  due.notify("told");
  CHECK(due.has_notified());
  CHECK(due.take(at(1).mono) == Runs{"told"});
  CHECK_FALSE(due.has_notified());
  CHECK(due.take(at(1).mono).empty());
  CHECK(due.next() == at(60).mono);
}

TEST_CASE("a run is due when its moment has come, and not before") {
  DueRuns due;
  due.schedule("late", at(20).mono);
  due.schedule("soon", at(10).mono);
  CHECK_FALSE(due.has_notified());
  CHECK(due.next() == at(10).mono);
  CHECK(due.take(at(9.999).mono).empty());
  CHECK(due.take(at(10).mono) == Runs{"soon"});
  CHECK(due.next() == at(20).mono);
  CHECK(due.take(at(30).mono) == Runs{"late"});
  CHECK_FALSE(due.next());
  CHECK(due.take(at(1000).mono).empty());
}

TEST_CASE("a run's new moment takes the place of the one before") {
  DueRuns due;
  due.schedule("run", at(10).mono);
  due.schedule("run", at(20).mono);
  CHECK(due.take(at(10).mono).empty());
  due.schedule("run", at(15).mono);
  CHECK(due.next() == at(15).mono);
  due.schedule("run", std::nullopt);
  CHECK_FALSE(due.next());
  CHECK(due.take(at(1000).mono).empty());
}

TEST_CASE("a run can be due earlier than it was, but not later") {
  DueRuns due;
  due.hasten("run", at(20).mono);
  CHECK(due.next() == at(20).mono);
  due.hasten("run", at(30).mono);
  due.hasten("run", std::nullopt);
  CHECK(due.next() == at(20).mono);
  due.hasten("run", at(10).mono);
  CHECK(due.take(at(10).mono) == Runs{"run"});
}

TEST_CASE("a run that is looked at for what was told has no moment until it is given one anew") {
  DueRuns due;
  due.schedule("run", at(10).mono);
  due.notify("run");
  CHECK(due.take(at(5).mono) == Runs{"run"});
  CHECK(due.take(at(10).mono).empty());
  due.schedule("run", at(12).mono);
  CHECK(due.take(at(12).mono) == Runs{"run"});
}

TEST_CASE("runs with the same moment are due together, by id") {
  DueRuns due;
  for (const char* run : {"c", "a", "b"}) due.schedule(run, at(10).mono);
  due.notify("d");
  const Runs taken = due.take(at(10).mono);
  CHECK(std::vector<std::string>(taken.begin(), taken.end()) == std::vector<std::string>{"a", "b", "c", "d"});
}
