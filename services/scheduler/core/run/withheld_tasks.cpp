#include "services/scheduler/core/run/withheld_tasks.hpp"

namespace trb::scheduler {

void WithheldTasks::give_back(const std::vector<TaskIndex>& tasks, bool stop) {
  asked_back_.insert(tasks.begin(), tasks.end());
  if (stop) to_stop_.insert(tasks.begin(), tasks.end());
  ++changes_;
}

bool WithheldTasks::withhold_all() {
  if (all_) return false;
  all_ = true;
  ++changes_;
  return true;
}

void WithheldTasks::drop(TaskIndex task) {
  asked_back_.erase(task);
  to_stop_.erase(task);
  failing_.erase(task);
  ++changes_;
}

}  // namespace trb::scheduler
