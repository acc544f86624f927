#include "services/scheduler/core/run/reports.hpp"

#include <utility>

namespace trb::scheduler {

bool Reports::add(const std::vector<bool>& final_tasks, const std::vector<bool>& skipped_tasks) {
  bool is_new = false;
  for (std::size_t i = 0; i < final_.size(); ++i) {
    const bool skipped = final_tasks[i] && skipped_tasks[i];
    is_new = is_new || (final_tasks[i] && !final_[i]) || (skipped && !skipped_[i]);
    final_[i] = final_[i] || final_tasks[i];
    skipped_[i] = skipped_[i] || skipped;
  }
  return is_new;
}

void Reports::note_progress(TaskIndex task, TaskState state, const std::string& wait) {
  note_wait(task, wait);
  obstacles_.erase(task);
  const auto [known, is_new] = progress_.try_emplace(task, state);
  if (std::exchange(known->second, state) != state || is_new) note_change(task);
}

void Reports::note_obstacle(TaskIndex task, const std::string& robot, const std::string& what) {
  if (obstacle_of(task, robot) == what) return;
  obstacles_[task] = {robot, what};
  note_change(task);
}

std::string Reports::obstacle_of(TaskIndex task, const std::string& robot) const {
  const auto found = obstacles_.find(task);
  return found == obstacles_.end() || found->second.robot != robot ? std::string() : found->second.what;
}

void Reports::note_wait(TaskIndex task, const std::string& what) {
  std::string& known = waits_[task];
  if (known == what) return;
  known = what;
  note_change(task);
}

void Reports::note_change(TaskIndex task) {
  if (told_[task] == kMostChanges) return;
  ++told_[task];
  ++changes_;
}

/// What its condition waits for stays: it is about the time before an attempt.
void Reports::forget_progress(TaskIndex task) {
  told_.erase(task);
  obstacles_.erase(task);
  if (progress_.erase(task) != 0) waits_.erase(task);
}

std::optional<TaskState> Reports::progress_of(TaskIndex task) const {
  const auto found = progress_.find(task);
  if (found == progress_.end()) return std::nullopt;
  return found->second;
}

std::vector<TaskIndex> Reports::running() const {
  std::vector<TaskIndex> out;
  for (const auto& [task, state] : progress_) {
    if (state == TaskState::running) out.push_back(task);
  }
  return out;
}

std::string Reports::first_wait() const {
  for (const auto& [task, what] : waits_) {
    if (!what.empty()) return what;
  }
  return {};
}

}  // namespace trb::scheduler
