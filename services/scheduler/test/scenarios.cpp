#include "services/scheduler/test/scenarios.hpp"
#include "common/scenario/graph.hpp"

namespace trb::scheduler::test {

Scenario nine_tasks() {
  Scenario scenario;
  scenario.name = "demonstration";
  const auto add = [&](const char* id, const char* robot, const char* skill, std::vector<TaskIndex> after) {
    Task task;
    task.id = id;
    task.robot = robot;
    task.skill = skill;
    task.after = std::move(after);
    scenario.tasks.push_back(std::move(task));
  };
  add("bring_box", "ridgeback", "go_to", {});
  add("move_box", "conveyor", "run_belt", {0});
  add("put_down", "ur3", "grab", {1});
  add("approach", "pioneer", "go_to", {2});
  add("take_off", "drone", "take_off", {3});
  add("pick", "ur3", "grab_left", {3});
  add("go_back", "pioneer", "go_to", {4, 5});
  add("land", "drone", "land", {6});
  add("load_out", "ridgeback", "go_to", {6});
  return scenario;
}

Scenario chain(const std::vector<std::string>& robots) {
  Scenario scenario;
  scenario.name = "chain";
  for (std::size_t i = 0; i < robots.size(); ++i) {
    Task task;
    task.id = "task-" + std::to_string(i);
    task.robot = robots[i];
    task.skill = "go_to";
    if (i > 0) task.after = {static_cast<TaskIndex>(i - 1)};
    scenario.tasks.push_back(std::move(task));
  }
  return scenario;
}

}  // namespace trb::scheduler::test
