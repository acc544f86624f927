// What others report on a run without proof: it is shown, and a restart forgets it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/scenario/graph.hpp"
#include "proto/bodies/run_exchange.hpp"

namespace trb::scheduler {

class Reports {
 public:
  static constexpr unsigned kMostChanges = 64;

  explicit Reports(std::size_t tasks) : final_(tasks, false), skipped_(tasks, false) {}

  /// What a baton states of each task; true if some of it is new.
  bool add(const std::vector<bool>& final_tasks, const std::vector<bool>& skipped_tasks);
  [[nodiscard]] const std::vector<bool>& final_tasks() const { return final_; }
  [[nodiscard]] const std::vector<bool>& skipped_tasks() const { return skipped_; }

  /// Its robot reports that the attempt is under way; `wait`: what it waits for before it begins, empty: nothing.
  void note_progress(TaskIndex task, TaskState state, const std::string& wait = {});
  [[nodiscard]] std::optional<TaskState> progress_of(TaskIndex task) const;
  [[nodiscard]] bool is_under_way(TaskIndex task) const { return progress_.contains(task); }
  /// What runs by now, as their robots report.
  [[nodiscard]] std::vector<TaskIndex> running() const;
  void forget_progress(TaskIndex task);

  /// What keeps that robot from the task that is due at it, as its node tells of itself; empty: nothing.
  void note_obstacle(TaskIndex task, const std::string& robot, const std::string& what);
  /// Empty also if it is not known of that robot.
  [[nodiscard]] std::string obstacle_of(TaskIndex task, const std::string& robot) const;

  /// What its condition waits for; empty: for nothing any more.
  void note_wait(TaskIndex task, const std::string& what);
  void forget_wait(TaskIndex task) { waits_.erase(task); }
  /// What the first task waits for, of those reported; empty: none waits.
  [[nodiscard]] std::string first_wait() const;

  /// Rises when what is shown of a task changes: kMostChanges times for each attempt, so that no robot floods those who
  /// watch the run.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

 private:
  void note_change(TaskIndex task);

  std::vector<bool> final_;
  std::vector<bool> skipped_;
  std::map<TaskIndex, TaskState> progress_;
  std::map<TaskIndex, std::string> waits_;
  struct Obstacle {
    std::string robot;
    std::string what;
  };
  std::map<TaskIndex, Obstacle> obstacles_;
  std::map<TaskIndex, unsigned> told_;  ///< changes of its attempt
  std::uint64_t changes_ = 0;
};

}  // namespace trb::scheduler
