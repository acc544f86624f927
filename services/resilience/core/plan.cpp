#include "services/resilience/core/plan.hpp"

#include <algorithm>

namespace trb::resilience {
namespace {

/// The alert's tasks that the verdict still concerns.
std::vector<std::size_t> tasks_of(const Alert& alert, const WatchedRun& run) {
  std::vector<std::size_t> out;
  for (const std::string& id : alert.tasks) {
    const auto index = run.find_task(id);
    if (!index) continue;
    const TaskView& task = run.view->tasks[*index];
    if (task.robot == alert.robot && !is_final(task)) out.push_back(*index);
  }
  const auto stopped = [&](std::size_t task) { return run.has_stopped(task); };
  const bool some = std::ranges::any_of(out, stopped);
  // A running task needs no second try. A task that has not failed is skipped only if none has.
  const bool only_stopped = alert.verdict == Verdict::retry || (alert.verdict == Verdict::skip && some);
  if (only_stopped) std::erase_if(out, [&](std::size_t task) { return !stopped(task); });
  return out;
}

std::string taker_of(const Alert& alert, const std::string& task, const std::string& node) {
  if (alert.verdict == Verdict::skip) return node;
  if (alert.verdict == Verdict::retry) return alert.robot;
  for (const TaskForRobot& one : alert.proposals.front().tasks) {
    if (one.task == task) return one.robot;
  }
  return {};
}

Ruling ruling_of(Verdict verdict) {
  if (verdict == Verdict::skip) return Ruling::skip;
  return verdict == Verdict::retry ? Ruling::retry : Ruling::move;
}

std::string awaited(const WatchedRun& run, const TaskView& task, const Fleet& fleet) {
  if (has_new_keys(run, task.robot, fleet)) {
    return task.robot + " has got new keys, and cannot give task '" + task.id +
           "' back: your word that it stands (--stands)";
  }
  const RobotRecord* robot = fleet.find(task.robot);
  if (robot == nullptr || !robot->reached) {
    return task.robot + " is silent: its word on task '" + task.id + "', or yours that it stands (--stands)";
  }
  const bool runs = task.state == TaskState::running || task.state == TaskState::paused;
  return runs ? "task '" + task.id + "' runs at " + task.robot + ": its end"
              : task.robot + " to give task '" + task.id + "' back";
}

bool is_reached(const Fleet& fleet, const std::string& id) {
  const RobotRecord* robot = fleet.find(id);
  return robot != nullptr && robot->reached;
}

}  // namespace

Plan plan_of(const Alert& alert, const WatchedRun& run, const Fleet& fleet, const std::string& node, bool asked_long) {
  Plan out;
  const auto wait = [&](const std::string& what) {
    if (out.waits_for.empty()) out.waits_for = what;
  };
  for (const std::size_t index : tasks_of(alert, run)) {
    const TaskView& task = run.view->tasks[index];
    TaskRuling ruling{task.id, ruling_of(alert.verdict), taker_of(alert, task.id, node), run.last_attempt(index) + 1,
                      Evidence::result};
    if (ruling.robot.empty()) continue;
    const std::string why = why_confirmation(run, index, fleet, alert.verdict == Verdict::retry);
    const bool open = !run.has_stopped(index);
    // A reachable robot is asked first: its result may be under way.
    const bool word_counts = !why.empty() || (open && (asked_long || !is_reached(fleet, task.robot)));
    if (alert.needs_word && word_counts) {
      ruling.evidence = Evidence::word;
      ruling.attempt = run.last_possible_attempt(index) + 1;
    } else if (open) {
      out.release.push_back(static_cast<std::uint16_t>(index));
      wait(awaited(run, task, fleet));
    } else if (!why.empty()) {
      wait(why + ": your word that " + task.robot + " stands (--stands)");
    }
    out.rulings.push_back(std::move(ruling));
  }
  return out;
}

}  // namespace trb::resilience
