#pragma once

namespace trb::virtual_robots {

/** Where a base is in the hall: metres and radians. */
struct Pose {
  double x = 0;
  double y = 0;
  double yaw = 0;
};

/** Metres and radians a second, in the robot's own frame. */
struct Velocity {
  double x = 0;
  double y = 0;
  double turn = 0;
};

}  // namespace trb::virtual_robots
