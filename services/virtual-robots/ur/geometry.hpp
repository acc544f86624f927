#pragma once

#include "services/virtual-robots/ur/script.hpp"

namespace trb::virtual_robots::ur {

using Vector = std::array<double, 3>;

/** A frame: its axes, and its origin, in the frame around it. */
struct Frame {
  Vector x{1, 0, 0};
  Vector y{0, 1, 0};
  Vector z{0, 0, 1};
  Vector origin{};
};

/** a x + b y */
Vector sum(double a, const Vector& x, double b, const Vector& y);
Vector cross(const Vector& a, const Vector& b);
double dot(const Vector& a, const Vector& b);

/** Where `inner` is, seen from what is around `outer`. */
Frame compose(const Frame& outer, const Frame& inner);
Frame inverse(const Frame& frame);

/** A pose is x y z in metres and a rotation vector in radians, as the maker writes it. */
Frame frame_of(const Pose& pose);
Pose pose_of(const Frame& frame);

/** The pose on the straight way from one to the other; the turn is even. `fraction`: 0 to 1. */
Pose pose_between(const Pose& from, const Pose& to, double fraction);
/** The way of the origin in metres, and the turn in radians. */
double way_between(const Pose& from, const Pose& to);
double turn_between(const Pose& from, const Pose& to);

}  // namespace trb::virtual_robots::ur
