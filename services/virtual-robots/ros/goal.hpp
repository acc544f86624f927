#pragma once

#include <string>

#include "services/virtual-robots/support/pose.hpp"

namespace trb::virtual_robots::ros {

/** A pose as a client sends it: metres, and a quaternion of any length. */
struct SentPose {
  double x = 0;
  double y = 0;
  double z = 0;
  double qx = 0;
  double qy = 0;
  double qz = 0;
  double qw = 0;
};

/** Where to go in the map, or why not. */
struct Goal {
  Pose pose;
  std::string refused;  // empty: it is taken
};

/**
 * What move_base makes of a goal: it knows the frames of the map, of odometry (here the map's) and of the robot itself,
 * which is at `here`. Refused: another frame, a number that is not finite, a quaternion of no length or one that leans.
 */
Goal goal_in_map(const std::string& frame, const SentPose& sent, const Pose& here);

}  // namespace trb::virtual_robots::ros
