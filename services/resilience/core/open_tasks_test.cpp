#include "services/resilience/core/open_tasks.hpp"

#include <doctest/doctest.h>

#include <utility>
#include <vector>

using namespace trb;
using namespace trb::resilience;

namespace {

using Robots = std::set<std::string>;

WatchedRun run_of(const std::vector<std::pair<std::string, TaskState>>& tasks) {
  WatchedRun out;
  out.view.emplace();
  for (const auto& [robot, state] : tasks) {
    TaskView& task = out.view->tasks.emplace_back();
    task.robot = robot;
    task.state = state;
  }
  return out;
}

}  // namespace

TEST_CASE("a robot's open tasks are those of all runs that are not final") {
  OpenTasks open;
  const WatchedRun one = run_of({{"r1", TaskState::finished}, {"r1", TaskState::running}, {"", TaskState::waiting}});
  const WatchedRun two = run_of({{"r1", TaskState::waiting}, {"r2", TaskState::waiting}});
  CHECK(open.count("one", &one) == Robots{"r1"});
  CHECK(open.count("two", &two) == Robots{"r1", "r2"});
  CHECK(open.of("r1") == 2);
  CHECK(open.of("r2") == 1);
  CHECK(open.of("nobody") == 0);
}

TEST_CASE("a run that is counted anew counts once, and a run that is over not at all") {
  OpenTasks open;
  const WatchedRun before = run_of({{"r1", TaskState::waiting}, {"r1", TaskState::waiting}});
  const WatchedRun after = run_of({{"r1", TaskState::waiting}, {"r2", TaskState::waiting}});
  open.count("run", &before);
  CHECK(open.count("run", &after) == Robots{"r1", "r2"});
  CHECK(open.of("r1") == 1);
  CHECK(open.count("run", nullptr) == Robots{"r1", "r2"});
  CHECK(open.of("r1") == 0);
  CHECK(open.of("r2") == 0);
  CHECK(open.count("run", nullptr).empty());
}
