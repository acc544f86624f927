#include "services/scheduler/test/scenarios.hpp"
#include "common/scenario/graph.hpp"
#include "common/scenario/test/make_task.hpp"

namespace trb::scheduler::test {

Scenario nine_tasks() {
  Scenario scenario;
  scenario.name = "demonstration";
  scenario.tasks = {
      make_task("bring_box", "ridgeback", "go_to"),     make_task("move_box", "conveyor", "run_belt", {0}),
      make_task("put_down", "ur3", "grab", {1}),        make_task("approach", "pioneer", "go_to", {2}),
      make_task("take_off", "drone", "take_off", {3}),  make_task("pick", "ur3", "grab_left", {3}),
      make_task("go_back", "pioneer", "go_to", {4, 5}), make_task("land", "drone", "land", {6}),
      make_task("load_out", "ridgeback", "go_to", {6}),
  };
  return scenario;
}

Scenario chain(const std::vector<std::string>& robots) {
  Scenario scenario;
  scenario.name = "chain";
  for (std::size_t i = 0; i < robots.size(); ++i) {
    scenario.tasks.push_back(make_task("task-" + std::to_string(i), robots[i], "go_to"));
    if (i > 0) scenario.tasks.back().after = {static_cast<TaskIndex>(i - 1)};
  }
  return scenario;
}

}  // namespace trb::scheduler::test
