#pragma once

#include <optional>
#include <vector>

#include "services/virtual-robots/ur/kinematics.hpp"

namespace trb::virtual_robots::ur {

/** The joints along a move, evenly in time, the first where the arm is; and how long it takes, in seconds. */
struct Path {
  std::vector<Joints> points;
  double duration = 0;
};

inline constexpr double kDefaultJointSpeed = 1.05;
inline constexpr double kShortestJointMove = 0.1;
inline constexpr double kDefaultToolSpeed = 0.25;
inline constexpr double kShortestToolMove = 0.2;

/** The path of movej or movel. `tool`: from the flange to the tool's centre. Nothing: some of it is out of reach. */
std::optional<Path> path_of(const MoveStep& step, const Joints& from, const Frame& tool);

}  // namespace trb::virtual_robots::ur
