#include "services/scheduler/core/run/reports.hpp"

namespace trb::scheduler {

void Reports::add(const std::vector<bool>& final_tasks, const std::vector<bool>& skipped_tasks) {
  for (std::size_t i = 0; i < final_.size(); ++i) {
    final_[i] = final_[i] || final_tasks[i];
    skipped_[i] = skipped_[i] || (final_tasks[i] && skipped_tasks[i]);
  }
}

void Reports::note_progress(TaskIndex task, TaskState state, const std::string& wait) {
  progress_[task] = state;
  waits_.erase(task);
  if (!wait.empty()) waits_[task] = wait;
}

/// What its condition waits for stays: it is about the time before an attempt.
void Reports::forget_progress(TaskIndex task) {
  if (progress_.erase(task) != 0) waits_.erase(task);
}

std::optional<TaskState> Reports::progress_of(TaskIndex task) const {
  const auto found = progress_.find(task);
  if (found == progress_.end()) return std::nullopt;
  return found->second;
}

std::string Reports::first_wait() const {
  for (const auto& [task, what] : waits_) {
    if (!what.empty()) return what;
  }
  return {};
}

}  // namespace trb::scheduler
