// A task of a scenario, for tests that need no more of it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/scenario/graph.hpp"

namespace trb {

inline Task make_task(std::string id, std::string robot, std::string skill, std::vector<TaskIndex> after = {}) {
  Task out;
  out.id = std::move(id);
  out.robot = std::move(robot);
  out.skill = std::move(skill);
  out.after = std::move(after);
  return out;
}

}  // namespace trb
