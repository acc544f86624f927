// The room that a robot's results without data have in a run in any case, so that each of its tasks can end.
#pragma once

#include <algorithm>
#include <string>

#include "services/scheduler/core/run_store.hpp"

namespace trb::scheduler {

/// Of a result without data, with its record: it takes some 0.8 kB.
constexpr std::size_t kBytesWithoutData = 1024;

/// What this node's next result leaves free: what goes beside its data (a reason of 1 kB and the record is small), and
/// a result without data of each of its tasks that is not final.
inline std::size_t bytes_besides(const Run& run) {
  const auto open =
      std::ranges::count_if(run.epochs().own_tasks(), [&](TaskIndex task) { return !run.results().has_final(task); });
  return 4096 + kBytesWithoutData * static_cast<std::size_t>(open);
}

/// What the run takes of that robot's results in any case, however much that robot has in other runs.
inline std::size_t free_bytes(const Run& run, const std::string& robot) {
  std::size_t tasks = 0;
  for (std::size_t i = 0; i < run.tasks().size(); ++i) {
    if (run.epochs().robot_of(static_cast<TaskIndex>(i)) == robot) ++tasks;
  }
  return RunStore::kFreeBytes + kBytesWithoutData * tasks;
}

}  // namespace trb::scheduler
