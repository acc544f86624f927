// What this node's robot does next: which run's turn it is, which task begins, what its attempt is allowed.
#pragma once

#include <string>
#include <vector>

#include "services/scheduler/core/due_tasks.hpp"
#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/lost_journal.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

class RobotSchedule {
 public:
  /// All must outlive it.
  RobotSchedule(const RunStore& runs, Executor& executor, const DueTasks& due, const LostJournal& lost)
      : runs_(runs), executor_(executor), due_(due), lost_(lost) {}

  /// Takes up the attempt whose start record was found without a result, if there is one.
  void resume_attempt();
  /// At a step's end: says what the run allows the attempt by now.
  void permit_attempt(Step step);
  /// At a step's end: begins the next attempt, if the robot is free for one.
  void start_next(Step step);

 private:
  struct Allowed {
    Permit permit{};
    std::string why;
  };
  [[nodiscard]] Allowed allowed(const Run& run, const AttemptKey& key, Step step) const;
  [[nodiscard]] std::vector<Run*> by_turn() const;
  /// True if the robot has got its next task.
  bool start_of(Run& run, Step step);
  void start(Run& run, TaskIndex task, Step step);

  const RunStore& runs_;
  Executor& executor_;
  const DueTasks& due_;
  const LostJournal& lost_;
};

}  // namespace trb::scheduler
