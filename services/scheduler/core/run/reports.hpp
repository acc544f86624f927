// What others report on a run without proof: it is shown, and a restart forgets it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/scenario/graph.hpp"
#include "proto/bodies/run_exchange.hpp"

namespace trb::scheduler {

class Reports {
 public:
  explicit Reports(std::size_t tasks) : final_(tasks, false), skipped_(tasks, false) {}

  /// What a baton states of each task.
  void add(const std::vector<bool>& final_tasks, const std::vector<bool>& skipped_tasks);
  [[nodiscard]] const std::vector<bool>& final_tasks() const { return final_; }
  [[nodiscard]] const std::vector<bool>& skipped_tasks() const { return skipped_; }

  /// Its robot reports that the attempt is under way; `wait`: what it waits for before it begins, empty: nothing.
  void note_progress(TaskIndex task, TaskState state, const std::string& wait = {});
  [[nodiscard]] std::optional<TaskState> progress_of(TaskIndex task) const;
  [[nodiscard]] bool is_under_way(TaskIndex task) const { return progress_.contains(task); }
  void forget_progress(TaskIndex task);

  /// What its condition waits for; empty: for nothing any more.
  void note_wait(TaskIndex task, const std::string& what) { waits_[task] = what; }
  void forget_wait(TaskIndex task) { waits_.erase(task); }
  /// What the first task waits for, of those reported; empty: none waits.
  [[nodiscard]] std::string first_wait() const;

 private:
  std::vector<bool> final_;
  std::vector<bool> skipped_;
  std::map<TaskIndex, TaskState> progress_;
  std::map<TaskIndex, std::string> waits_;
};

}  // namespace trb::scheduler
