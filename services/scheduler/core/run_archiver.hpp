// How runs end: once nothing is left to be done or sent for one, it goes to the archive.
#pragma once

#include <string>

#include "services/scheduler/core/executor.hpp"
#include "services/scheduler/core/run_store.hpp"
#include "services/scheduler/core/step.hpp"
#include "services/scheduler/core/watchers.hpp"

namespace trb::scheduler {

class RunArchiver {
 public:
  /// `has_robot`: the node has a mode-adapter. All must outlive it.
  RunArchiver(bool has_robot, RunStore& runs, const Executor& executor, Watchers& watchers)
      : has_robot_(has_robot), runs_(runs), executor_(executor), watchers_(watchers) {}

  /// At a step's end, of a run that is not open any more: archives it once it is over, after a while of grace.
  void archive_if_over(Run& run, Step step);

 private:
  [[nodiscard]] bool is_over(const Run& run, Step step) const;
  void archive(Run& run, Step step);

  bool has_robot_;
  RunStore& runs_;
  const Executor& executor_;
  Watchers& watchers_;
};

}  // namespace trb::scheduler
