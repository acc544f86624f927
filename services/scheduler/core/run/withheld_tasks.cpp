#include "services/scheduler/core/run/withheld_tasks.hpp"

namespace trb::scheduler {

void WithheldTasks::drop(TaskIndex task) {
  asked_back_.erase(task);
  failing_.erase(task);
}

}  // namespace trb::scheduler
