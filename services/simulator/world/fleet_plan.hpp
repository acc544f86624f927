// The robots of a world: the paper's, which can do one thing, or those of a hall as their nodes describe them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/fleet/description.hpp"
#include "common/simulation/skill_time.hpp"
#include "proto/bodies/link.hpp"

namespace trb::world {

using simulation::SkillTime;

struct PlannedRobot {
  std::string id;
  NodeProfile profile;  ///< of it capabilities, skills and places
};

constexpr double kUsualTimeout_s = 600;

/// `count` robots r0, r1 ... that can "work", for so long at most.
std::vector<PlannedRobot> paper_robots(std::uint32_t count, double timeout_s = kUsualTimeout_s);

/// As its mode-adapter has it: a robot that is told each skill by its name, field by field.
Description description_of(const NodeProfile& profile);

}  // namespace trb::world
