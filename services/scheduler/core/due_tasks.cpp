#include "services/scheduler/core/due_tasks.hpp"

#include <cstdio>

namespace trb::scheduler {
namespace {

/// Who has ended a task passes it on within seconds; the decider waits longer for it than a restart takes.
constexpr Duration kPassPatience = std::chrono::seconds(30);

}  // namespace

bool DueTasks::is_doing(const Run& run, TaskIndex task) const {
  if (!executor_.runs(run.id()) || executor_.attempt()->execute.key.task != run.tasks()[task].id) return false;
  const Phase phase = executor_.attempt()->phase;
  return phase == Phase::running || phase == Phase::signing;
}

void DueTasks::update(Run& run, Step step) const {
  TaskTimers& timers = run.work().timers();
  const bool goes_on = run.orders().goes_on();
  if (!goes_on) timers.drop_all_due();
  // No fact of the run says that a task has begun.
  timers.drop_due_if([&](TaskIndex task) { return run.reports().is_under_way(task) || is_doing(run, task); });
  if (!timers.take_version(run.version() + run.deliveries().pending().changes())) return;
  std::vector<TaskIndex> unpassed;
  if (goes_on) unpassed = run.deliveries().unpassed();
  timers.set_passes(std::move(unpassed), step.now.mono + kPassPatience);
  if (!goes_on) return;
  std::vector<TaskIndex> due = run.open_tasks().due();
  if (executor_.runs(run.id())) {
    const TaskIndex task = *run.index_of(executor_.attempt()->execute.key.task);
    if (!is_doing(run, task)) due.push_back(task);
  }
  timers.set_due(std::move(due), step.now.mono);
}

bool DueTasks::is_late(const Run& run, TaskIndex task, Step step) {
  return run.work().timers().is_late(task, run.tasks()[task].start_within_s, step.now.mono);
}

std::string DueTasks::late_text(const Run& run, TaskIndex task) const {
  const std::string why = executor_.obstacle(run.tasks()[task].skill);
  char within[32];
  std::snprintf(within, sizeof within, "%g s", run.tasks()[task].start_within_s);
  return "it did not begin within " + std::string(within) + (why.empty() ? "" : ": " + why);
}

std::optional<MonotonicTime> DueTasks::next_late(const Run& run, MonotonicTime now) {
  std::optional<MonotonicTime> out;
  for (const auto& [task, since] : run.work().timers().due_since()) {
    const double within_s = run.tasks()[task].start_within_s;
    const MonotonicTime late = since + seconds(within_s);
    if (within_s > 0 && run.epochs().is_own(task) && late > now) out = earlier(out, late);
  }
  return out;
}

}  // namespace trb::scheduler
