#include "services/scheduler/core/view.hpp"

#include <doctest/doctest.h>

#include "proto/body.hpp"
#include "proto/message.hpp"

using namespace trb;
using namespace trb::scheduler;

TEST_CASE("the view of the largest run is a message that its reader takes; a usual one is left whole") {
  const auto make = [](std::size_t tasks, std::size_t decisions) {
    const std::string name(64, 'n');
    RunView view;
    for (std::size_t i = 0; i < tasks; ++i) {
      TaskView task;
      task.id = task.robot = task.skill = task.moved_from = name;
      task.reason = std::string(1024, 'r');
      task.condition = std::string(512, 'c');
      task.after.assign(tasks / 10, static_cast<TaskIndex>(tasks - 1));
      view.tasks.push_back(task);
    }
    for (std::size_t i = 0; i < decisions; ++i) {
      DecisionView decision;
      decision.reason = std::string(1024, 'd');
      decision.tasks.assign(tasks, TaskRuling{name, Ruling::move, name, 1, Evidence::word});
      view.decisions.push_back(decision);
    }
    return view;
  };
  RunView large = make(1000, 64);
  CHECK_FALSE(pack(large).ok());
  fit(large);
  const auto packed = pack(large);
  REQUIRE(packed.ok());
  CHECK(packed->size() <= kMaxDataSize);
  CHECK(large.tasks.size() == 1000);
  CHECK(large.tasks[999].after.size() == 100);
  CHECK(large.decisions.size() == 64);
  RunView usual = make(100, 4);
  const Bytes before = encode(usual);
  fit(usual);
  CHECK(encode(usual) == before);
}
