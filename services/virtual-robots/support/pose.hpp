#pragma once

namespace trb::virtual_robots {

/** Where a base is in the hall: metres and radians. */
struct Pose {
  double x = 0;
  double y = 0;
  double yaw = 0;
};

}  // namespace trb::virtual_robots
