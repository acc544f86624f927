#pragma once

#include <optional>

#include "services/virtual-robots/ur/geometry.hpp"

namespace trb::virtual_robots::ur {

/** Metres and radians a second of the tool's flange, in the frame of the arm's foot: x y z, then about x y z. */
using Twist = std::array<double, 6>;

/** Denavit and Hartenberg's parameters of one joint. */
struct Link {
  double a;
  double d;
  double alpha;
};
/** Those of a UR3, as its maker publishes them. */
extern const std::array<Link, kJointCount> kLinks;

/** Where the flange is: x y z, in the frame of the arm's foot. */
Vector flange_of(const Joints& joints);
Frame flange_frame(const Joints& joints);
Vector elbow_of(const Joints& joints);

/** No joint turns farther than this to either side. */
inline constexpr double kJointLimit = 2 * 3.14159265358979323846;

/** The joints that bring the flange there: of all that do, those nearest to `near`. Nothing: out of reach. */
std::optional<Joints> joints_for(const Frame& flange, const Joints& near);

/** The flange's twist at these joint speeds. */
Twist twist_of(const Joints& joints, const Joints& speeds);

/**
 * The joint speeds that give the twist. Near a singularity no joint exceeds what a joint can do: then all are slower,
 * and damped.
 */
Joints speeds_for(const Joints& joints, const Twist& twist);

}  // namespace trb::virtual_robots::ur
