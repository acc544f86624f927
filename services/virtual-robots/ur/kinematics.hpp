#pragma once

#include "services/virtual-robots/ur/script.hpp"

namespace trb::virtual_robots::ur {

/** Metres and radians a second of the tool's flange, in the frame of the arm's foot: x y z, then about x y z. */
using Twist = std::array<double, 6>;

/** Where the flange is: x y z, in the frame of the arm's foot. */
std::array<double, 3> flange_of(const Joints& joints);

/** The flange's twist at these joint speeds. */
Twist twist_of(const Joints& joints, const Joints& speeds);

/**
 * The joint speeds that give the twist. Near a singularity no joint exceeds what a joint can do: then all are slower,
 * and damped.
 */
Joints speeds_for(const Joints& joints, const Twist& twist);

}  // namespace trb::virtual_robots::ur
