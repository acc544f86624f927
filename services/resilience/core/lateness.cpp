// ResilienceCore: tasks that are overdue, and those that their scenario does without.
#include <algorithm>

#include "common/ranking/pairwise.hpp"
#include "services/resilience/core/resilience_core.hpp"

namespace trb::resilience {

/// Of what no other alert tells, one for each robot.
std::vector<Trouble> ResilienceCore::overdue_troubles(const WatchedRun& run, Now now) {
  std::set<std::string> told_otherwise;
  std::set<std::string> told;
  for (const Alert* alert : book_.open()) {
    if (alert->run != run.summary.run) continue;
    auto& tasks = alert->cause == kOverdue && alert->state != AlertState::releasing ? told : told_otherwise;
    tasks.insert(alert->tasks.begin(), alert->tasks.end());
  }
  overdue_.follow(run, told, now);
  std::vector<Trouble> out;
  for (Overdue::Late& late : overdue_.late(run, fleet_, now)) {
    const TaskView& task = run.view->tasks[late.task];
    if (told_otherwise.contains(task.id)) continue;
    auto at = std::ranges::find(out, task.robot, &Trouble::robot);
    if (at == out.end()) {
      Trouble fresh;
      fresh.robot = task.robot;
      fresh.severity = Severity::urgent;
      fresh.cause = kOverdue;
      fresh.text = std::move(late.text);
      at = out.insert(out.end(), std::move(fresh));
    }
    at->tasks.push_back(late.task);
    at->needs_word = at->needs_word || !why_word(run, late.task, fleet_, false).empty();
  }
  return out;
}

/// Its robot is gone and cannot say that it did not begin in time: the scenario's author has said what follows.
void ResilienceCore::skip_unbegun(const WatchedRun& run, Now now, Outbox& out) {
  if (run.decider() != settings_.node) return;
  for (const std::size_t index : overdue_.to_skip(run, now)) {
    const TaskView& task = run.view->tasks[index];
    if (presence_.find(task.robot, now) == nullptr) continue;
    overdue_.ruled(run, index);
    AlertDecide verdict;
    verdict.verdict = Verdict::skip;
    verdict.stands = true;
    verdict.reason = "did not begin within " + short_number(run.start->scenario.tasks[index].start_within_s) + " s";
    Alert alert = alert_of(run, task.robot, now);
    alert.cause = kOverdue;
    alert.severity = Severity::urgent;
    alert.text = "task '" + task.id + "' " + verdict.reason;
    alert.tasks = {task.id};
    if (const auto ruled = decide_anew(std::move(alert), verdict, now, out); !ruled) {
      out.log(LogLevel::warning, "not_skipped", "task '" + task.id + "': " + ruled.error().what);
    }
  }
}

}  // namespace trb::resilience
