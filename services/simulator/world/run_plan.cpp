#include "services/simulator/world/run_plan.hpp"

#include <algorithm>
#include <utility>

namespace trb::world {
namespace {

std::uint32_t run_of_task(std::uint32_t task, std::uint32_t robots, std::uint32_t runs) {
  return robots < runs ? task % runs : static_cast<std::uint32_t>(std::uint64_t{task % robots} * runs / robots);
}

void add_task(Scenario& to, const std::string& robot, bool at_once) {
  Task task;
  const std::size_t number = to.tasks.size();
  task.id = "t" + std::to_string(number);
  task.robot = robot;
  task.skill = "work";
  if (!at_once && number > 0) task.after = {static_cast<std::uint16_t>(number - 1)};
  to.tasks.push_back(std::move(task));
}

}  // namespace

Scenario in_turn(std::uint32_t count, const std::vector<PlannedRobot>& robots) {
  return std::move(divide(count, robots, {}).front().scenario);
}

std::vector<PlannedRun> divide(std::uint32_t tasks, const std::vector<PlannedRobot>& robots, const Division& division) {
  std::vector<PlannedRun> out(division.runs);
  const auto count = static_cast<std::uint32_t>(robots.size());
  for (std::uint32_t i = 0; i < tasks; ++i) {
    add_task(out[run_of_task(i, count, division.runs)].scenario, robots[i % count].id, division.at_once);
  }
  std::erase_if(out, [](const PlannedRun& run) { return run.scenario.tasks.empty(); });
  if (out.empty()) out.resize(1);
  const std::string name = division.at_once ? "at once" : "in turn";
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].scenario.name = out.size() == 1 ? name : name + ", run " + std::to_string(i + 1);
  }
  return out;
}

RunSize largest_run(std::uint32_t tasks, std::uint32_t robots, const Division& division) {
  std::vector<std::uint32_t> counts(division.runs), members(division.runs);
  for (std::uint32_t i = 0; i < tasks; ++i) {
    const std::uint32_t run = run_of_task(i, robots, division.runs);
    ++counts[run];
    if (i < robots) ++members[run];
  }
  RunSize out{*std::ranges::max_element(counts), *std::ranges::max_element(members)};
  if (robots < division.runs) out.robots = robots;  // at most: they share them
  return out;
}

}  // namespace trb::world
