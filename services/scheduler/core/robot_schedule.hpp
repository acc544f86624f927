// What this node's robot does next: which tasks are due or late, which run's turn it is, which task begins, what its
// attempt is allowed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/lost_journal.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

/// Notifies the cloud nodes of an attempt's progress. `wait`: what it waits for before it begins; empty: nothing.
void notify_progress(const Run& run, const AttemptKey& key, TaskState state, const std::string& wait, Step step);

class RobotSchedule {
 public:
  /// All must outlive it. `identity_key`: the public key that this node signs with; empty: unknown.
  RobotSchedule(const RunStore& runs, Executor& executor, const LostJournal& lost, Bytes identity_key = {})
      : runs_(runs), executor_(executor), lost_(lost), identity_key_(std::move(identity_key)) {}

  /// Takes up the attempt whose start record was found without a result, unless its result was signed and not
  /// believed.
  void resume_attempt();
  /// At a step's end, for each run: sets its timers by its facts.
  void update_due(Run& run, Step step) const;
  /// The same: tasks of this robot that have waited longer than their scenario lets them have failed, also while it is
  /// at another one.
  void fail_late(Run& run, Step step) const;
  /// Takes up the pauses of other robots before they try a task again. Only this process knew of them.
  static void resume_pauses(Run& run, Step step);
  /// When the next task of this node becomes late, after `now`.
  [[nodiscard]] static std::optional<MonotonicTime> next_late(const Run& run, MonotonicTime now);
  /// At a step's end: sets what the run allows the attempt by now.
  void permit_attempt(Step step);
  /// At a step's end: begins the next attempt, if the robot is free for one.
  void start_next(Step step);
  /// At a step's end: notifies the cloud nodes of what the attempt waits for, if the robot has refused it.
  void notify_wait(Step step);

 private:
  struct Allowed {
    Permit permit{};
    std::string why;
  };
  /// The run has another identity key of this node.
  [[nodiscard]] bool has_other_keys(const Run& run) const;
  /// This node's robot does it, or has done it.
  [[nodiscard]] bool is_doing(const Run& run, TaskIndex task) const;
  /// The task was due for longer than its scenario lets it wait.
  [[nodiscard]] static bool is_late(const Run& run, TaskIndex task, Step step);
  /// Why it did not begin, for a person.
  [[nodiscard]] std::string late_text(const Run& run, TaskIndex task) const;
  [[nodiscard]] Allowed allowed(const Run& run, const AttemptKey& key, Step step) const;
  [[nodiscard]] std::vector<const Run*> by_turn() const;
  /// True if the robot has got its next task.
  [[nodiscard]] bool is_surely_new(Run& run, TaskIndex task, UtcTime now) const;
  /// `is_blocked`: the robot can begin no skill at all.
  bool start_of(Run& run, bool is_blocked, Step step);
  void start(Run& run, TaskIndex task, Step step);

  const RunStore& runs_;
  Executor& executor_;
  const LostJournal& lost_;
  Bytes identity_key_;
};

}  // namespace trb::scheduler
