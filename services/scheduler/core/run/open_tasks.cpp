#include "services/scheduler/core/run/open_tasks.hpp"

namespace trb::scheduler {

const OpenTasks::Ready& OpenTasks::ready() const {
  const Version now{run_.facts.changes(), run_.epochs.current(), run_.work.withheld().changes()};
  if (ready_of_ == now) return ready_;
  ready_of_ = now;
  ready_ = {};
  for (const TaskIndex task : run_.epochs.own_tasks()) sort_in(task, ready_);
  for (const TaskIndex task : run_.epochs.concerned_tasks()) {
    if (has_to_choose(task)) ready_.to_choose.push_back(task);
  }
  return ready_;
}

void OpenTasks::sort_in(TaskIndex own, Ready& out) const {
  const bool is_final = run_.facts.results().has_final(own);
  out.own_are_final = out.own_are_final && is_final;
  out.own_has_failed = out.own_has_failed || (!is_final && run_.facts.results().of(own) != nullptr);
  if (!run_.facts.all_before_final(own) || run_.facts.has_begun(own) || run_.facts.current(own) != nullptr ||
      run_.work.withheld().contains(own)) {
    return;
  }
  switch (run_.facts.fate_of(own)) {
    case Fate::goes:
      return out.startable.push_back(own);
    case Fate::binds:
      return out.to_bind.push_back(own);
    case Fate::skipped:
      if (may_skip()) out.skippable.push_back(own);
      return;
    case Fate::undecided:
      return;
  }
}

/// Nothing else can be SKIPPED.
bool OpenTasks::may_skip() const {
  return run_.definition.has_conditions() || run_.definition.skips_on_failure() || !run_.epochs.decisions().empty();
}

bool OpenTasks::has_to_choose(TaskIndex task) const {
  return run_.epochs.chooses_here(task) && run_.facts.current(task) == nullptr && run_.facts.all_before_final(task) &&
         run_.facts.fate_of(task) == Fate::undecided;
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
  if (run_.reports.is_under_way(task) || run_.work.timers().waits(task)) return false;
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
  std::vector<bool> needed(known_final.size(), false);
  for (const TaskIndex task : run_.epochs.concerned_tasks()) {
    const Task& is = run_.definition.tasks()[task];
    if (run_.facts.current(task) != nullptr || !predecessors_final(is, known_final)) continue;
    for (const TaskIndex before : is.after) needed[before] = true;
  }
  std::vector<TaskIndex> out;
  for (std::size_t i = 0; i < needed.size(); ++i) {
    const auto task = static_cast<TaskIndex>(i);
    if (needed[i] && !run_.facts.results().has_final(task)) out.push_back(task);
  }
  return out;
}

}  // namespace trb::scheduler
