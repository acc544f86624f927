#include "services/resilience/core/open_tasks.hpp"

#include <utility>

namespace trb::resilience {

std::set<std::string> OpenTasks::count(const std::string& run, const WatchedRun* is) {
  ByRobot tasks;
  if (is != nullptr && is->view) {
    for (const TaskView& task : is->view->tasks) {
      if (!task.robot.empty() && !is_final(task)) ++tasks[task.robot];
    }
  }
  std::set<std::string> out;
  const ByRobot before = std::exchange(by_run_[run], tasks);
  for (const auto& [robot, number] : before) out.insert(robot);
  for (const auto& [robot, number] : tasks) out.insert(robot);
  subtract(before);
  add(tasks);
  if (tasks.empty()) by_run_.erase(run);
  return out;
}

void OpenTasks::add(const ByRobot& tasks) {
  for (const auto& [robot, number] : tasks) total_[robot] += number;
}

void OpenTasks::subtract(const ByRobot& tasks) {
  for (const auto& [robot, number] : tasks) {
    const auto at = total_.find(robot);
    at->second -= number;
    if (at->second == 0) total_.erase(at);
  }
}

std::uint32_t OpenTasks::of(std::string_view robot) const {
  const auto at = total_.find(robot);
  return at == total_.end() ? 0 : at->second;
}

}  // namespace trb::resilience
