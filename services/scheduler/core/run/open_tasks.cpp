#include "services/scheduler/core/run/open_tasks.hpp"

namespace trb::scheduler {

std::vector<TaskIndex> OpenTasks::own_tasks_that(Fate fate) const {
  std::vector<TaskIndex> out;
  for (const TaskIndex task : run_.epochs.own_tasks()) {
    if (run_.facts.has_begun(task) || run_.facts.current(task) != nullptr || run_.work.withheld().contains(task)) {
      continue;
    }
    if (run_.facts.all_before_final(task) && run_.facts.fate_of(task) == fate) out.push_back(task);
  }
  return out;
}

std::vector<TaskIndex> OpenTasks::skippable() const {
  return may_skip() ? own_tasks_that(Fate::skipped) : std::vector<TaskIndex>();
}

/// Saves a look at every task of a run in which nothing can be SKIPPED.
bool OpenTasks::may_skip() const {
  return run_.definition.has_conditions() || run_.definition.skips_on_failure() || !run_.epochs.decisions().empty();
}

std::vector<TaskIndex> OpenTasks::to_choose() const {
  std::vector<TaskIndex> out;
  for (const TaskIndex task : run_.epochs.concerned_tasks()) {
    if (!run_.epochs.chooses_here(task) || run_.facts.current(task) != nullptr) continue;
    if (run_.facts.all_before_final(task) && run_.facts.fate_of(task) == Fate::undecided) out.push_back(task);
  }
  return out;
}

std::vector<TaskIndex> OpenTasks::releasable() const {
  std::vector<TaskIndex> out;
  for (const TaskIndex task : run_.work.withheld().asked_back()) {
    const bool open = !run_.facts.has_begun(task) && run_.facts.current(task) == nullptr;
    if (open && run_.epochs.is_own(task)) out.push_back(task);
  }
  return out;
}

bool OpenTasks::is_due(TaskIndex task) const {
  if (run_.facts.results().has_final(task) || run_.facts.current(task) != nullptr) return false;
  if (run_.reports.is_under_way(task)) return false;
  const bool own = run_.epochs.is_own(task);
  if (!own && !run_.epochs.judges_here() && !run_.deliveries.pending().owes_baton(task)) return false;
  if (own && (run_.facts.has_begun(task) || run_.work.withheld().is_failing(task))) return false;
  return run_.facts.all_before_final(task) && run_.facts.fate_of(task) == Fate::goes;
}

std::vector<TaskIndex> OpenTasks::due() const {
  std::vector<TaskIndex> out;
  for (std::size_t i = 0; i < run_.definition.tasks().size(); ++i) {
    if (is_due(static_cast<TaskIndex>(i))) out.push_back(static_cast<TaskIndex>(i));
  }
  return out;
}

std::vector<TaskIndex> OpenTasks::choosing_elsewhere() const {
  std::vector<TaskIndex> out;
  if (!run_.epochs.judges_here()) return out;
  for (std::size_t i = 0; i < run_.definition.tasks().size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    const bool open =
        run_.definition.is_conditional(task) && !run_.epochs.chooses_here(task) && run_.facts.current(task) == nullptr;
    if (open && run_.facts.all_before_final(task) && run_.facts.fate_of(task) == Fate::undecided) out.push_back(task);
  }
  return out;
}

std::vector<TaskIndex> OpenTasks::missing_results(const std::vector<bool>& known_final) const {
  std::vector<TaskIndex> out;
  for (const TaskIndex task : run_.epochs.concerned_tasks()) {
    const Task& is = run_.definition.tasks()[task];
    if (run_.facts.current(task) != nullptr || !predecessors_final(is, known_final)) continue;
    for (const TaskIndex before : is.after) {
      if (!run_.facts.results().has_final(before)) out.push_back(before);
    }
  }
  return out;
}

}  // namespace trb::scheduler
