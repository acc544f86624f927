// A run's task as its definition has it and as the scheduler shows it.
#pragma once

#include <utility>

#include "proto/bodies/run_view.hpp"

namespace trb::resilience::test {

/// Nothing of it is done yet.
inline void add_task(Task task, RunStart& start, RunView& view) {
  TaskView shown;
  shown.id = task.id;
  shown.robot = task.robot;
  shown.skill = task.skill;
  start.scenario.tasks.push_back(std::move(task));
  view.tasks.push_back(std::move(shown));
}

}  // namespace trb::resilience::test
