// The epochs of a run: the decisions on it, and who has a task now. What ended before a decision on a task is void,
// unless it is final.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "services/scheduler/core/run/run_definition.hpp"

namespace trb::scheduler {

/// As many as a Definition carries.
constexpr std::size_t kMaxDecisions = 64;

class Epochs {
 public:
  /// `self`: this node. The definition must outlive it.
  Epochs(const RunDefinition& definition, std::string self);
  Epochs(const Epochs&) = delete;
  Epochs& operator=(const Epochs&) = delete;

  [[nodiscard]] const std::string& self() const { return self_; }
  /// The number of the epoch that counts: 1 is the start's.
  [[nodiscard]] std::uint32_t current() const { return static_cast<std::uint32_t>(decisions_.size()) + 1; }
  [[nodiscard]] const std::vector<Decision>& decisions() const { return decisions_; }
  [[nodiscard]] const std::vector<SignedRecord>& records() const { return records_; }
  /// The next epoch. The decision has been checked.
  void adopt(const SignedRecord& record, const Decision& decision);

  /// Whose the task is in this epoch.
  [[nodiscard]] const std::string& robot_of(TaskIndex task) const { return robots_[task]; }
  /// Whose it was in that epoch, 1 to current().
  [[nodiscard]] const std::string& robot_in(TaskIndex task, std::uint32_t epoch) const;
  /// The first attempt of whoever had the task in that epoch, 1 to current().
  [[nodiscard]] std::uint32_t first_attempt_in(TaskIndex task, std::uint32_t epoch) const;
  /// Whose a ruled task was before the last ruling.
  [[nodiscard]] const std::string& robot_before(TaskIndex task) const { return robot_in(task, since_[task] - 1); }
  /// The task was moved, repeated or skipped by a decision.
  [[nodiscard]] bool is_ruled(TaskIndex task) const { return since_[task] > 1; }
  /// The epoch of the last ruling on a task; 1: none.
  [[nodiscard]] std::uint32_t since(TaskIndex task) const { return since_[task]; }
  /// The decision with the last ruling on a ruled task.
  [[nodiscard]] const Decision& last_decision_on(TaskIndex task) const { return decisions_[since_[task] - 2]; }
  /// Earlier attempts are void, unless they are final.
  [[nodiscard]] std::uint32_t first_attempt(TaskIndex task) const { return first_attempt_[task]; }
  /// A decision has taken that attempt's task from its robot, or has it done again.
  [[nodiscard]] bool is_void(TaskIndex task, std::uint32_t attempt) const { return attempt < first_attempt_[task]; }
  /// The start has left it to the decider to choose its robot, and that has not happened: the decider's node holds it.
  [[nodiscard]] bool is_unbound(TaskIndex task) const;
  /// A decision says that it is SKIPPED.
  [[nodiscard]] bool is_skipped(TaskIndex task) const;
  /// None of these tasks was ruled on in a later epoch than that.
  [[nodiscard]] bool is_of_epoch(const std::vector<TaskIndex>& tasks, std::uint32_t epoch) const;
  /// The robot has lost a task because a person has stated that it stands.
  [[nodiscard]] bool is_vouched_still(const std::string& robot) const { return vouched_still_.contains(robot); }

  /// Where its condition is evaluated.
  [[nodiscard]] const std::string& chooser_of(TaskIndex task) const;
  [[nodiscard]] bool chooses_here(TaskIndex task) const;
  /// This node decides on the run.
  [[nodiscard]] bool decides_here() const { return definition_.rule().may_decide(self_); }
  /// This node holds every result in the end.
  [[nodiscard]] bool judges_here() const { return definition_.rule().judge() == self_; }
  /// This node executes the task.
  [[nodiscard]] bool is_own(TaskIndex task) const { return robot_of(task) == self_; }
  /// This node executes the task or evaluates its condition.
  [[nodiscard]] bool concerns(TaskIndex task) const { return is_own(task) || chooses_here(task); }
  /// The tasks that this node executes; ascending.
  [[nodiscard]] const std::vector<TaskIndex>& own_tasks() const { return own_tasks_; }
  /// The tasks that concern this node; ascending.
  [[nodiscard]] const std::vector<TaskIndex>& concerned_tasks() const { return concerned_; }

 private:
  void index_own_tasks();
  /// The ruling on a task that counts in that epoch, or nullptr.
  [[nodiscard]] const TaskRuling* ruling_in(TaskIndex task, std::uint32_t epoch) const;

  const RunDefinition& definition_;
  std::string self_;
  std::vector<Decision> decisions_;
  std::vector<SignedRecord> records_;
  std::vector<std::string> robots_;           ///< of this epoch
  std::vector<std::uint32_t> since_;          ///< the epoch of the last ruling on a task; 1: none
  std::vector<std::uint32_t> first_attempt_;  ///< that is not void
  std::set<std::string> vouched_still_;
  std::vector<TaskIndex> own_tasks_;
  std::vector<TaskIndex> concerned_;
};

}  // namespace trb::scheduler
