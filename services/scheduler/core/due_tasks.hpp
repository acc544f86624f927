// Which tasks are due, and since when; which of them are late.
#pragma once

#include <string>

#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run/run.hpp"
#include "services/scheduler/core/step.hpp"

namespace trb::scheduler {

class DueTasks {
 public:
  /// The executor must outlive it.
  explicit DueTasks(const Executor& executor) : executor_(executor) {}

  /// At a step's end: sets the run's timers by its facts.
  void update(Run& run, Step step) const;
  /// The task was due for longer than its scenario lets it wait.
  [[nodiscard]] static bool is_late(const Run& run, TaskIndex task, Step step);
  /// Why it did not begin, for a person.
  [[nodiscard]] std::string late_text(const Run& run, TaskIndex task) const;
  /// When the next task of this node becomes late, after `now`.
  [[nodiscard]] static std::optional<MonotonicTime> next_late(const Run& run, MonotonicTime now);

 private:
  /// This node's robot does it, or has done it.
  [[nodiscard]] bool is_doing(const Run& run, TaskIndex task) const;

  const Executor& executor_;
};

}  // namespace trb::scheduler
