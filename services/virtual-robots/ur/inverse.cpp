// The closed solution for an arm whose second to fourth axes are parallel: two shoulders, two wrists, two elbows.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/virtual-robots/ur/kinematics.hpp"

namespace trb::virtual_robots::ur {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
/** So much a cosine may exceed 1 by rounding: an arm that is stretched out is at its limit, not beyond it. */
constexpr double kSlack = 1e-9;
constexpr double kSingular = 1e-6;

std::optional<double> arc_cosine(double cosine) {
  if (!(std::abs(cosine) <= 1 + kSlack)) return std::nullopt;
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

/** The same angle by whole turns, as near as it can be, within the joint's limits. */
double nearest_turn(double angle, double near) {
  double best = angle + 2 * kHalfTurn * std::round((near - angle) / (2 * kHalfTurn));
  if (best > kJointLimit) best -= 2 * kHalfTurn;
  if (best < -kJointLimit) best += 2 * kHalfTurn;
  return best;
}

Frame joint_frame(std::size_t joint, double angle) {
  const Link& link = kLinks[joint];
  const double c = std::cos(angle), s = std::sin(angle);
  const double ca = std::cos(link.alpha), sa = std::sin(link.alpha);
  return {{c, s, 0}, {-s * ca, c * ca, sa}, {s * sa, -c * sa, ca}, {link.a * c, link.a * s, link.d}};
}

/** Keeps the solution nearest to where the arm is. */
class Nearest {
 public:
  explicit Nearest(const Joints& near) : near_(near) {}

  const Joints& near() const { return near_; }
  const std::optional<Joints>& best() const { return best_; }

  void offer(Joints joints) {
    double far = 0;
    for (std::size_t i = 0; i < kJointCount; ++i) {
      joints[i] = nearest_turn(joints[i], near_[i]);
      far += std::abs(joints[i] - near_[i]);
    }
    if (best_ && far >= distance_) return;
    best_ = joints;
    distance_ = far;
  }

 private:
  const Joints& near_;
  std::optional<Joints> best_;
  double distance_ = 0;
};

/** Shoulder, elbow and first wrist for a base and two wrists that are given. */
void offer_elbows(const Frame& flange, double base, double wrist_2, double wrist_3, Nearest& nearest) {
  const Frame wrist = compose(joint_frame(4, wrist_2), joint_frame(5, wrist_3));
  const Frame plane = compose(compose(inverse(joint_frame(0, base)), flange), inverse(wrist));
  // Behind the first wrist's own offset the three parallel axes form a triangle in one plane.
  const Vector point = sum(1, plane.origin, -kLinks[3].d, plane.y);
  const double upper = kLinks[1].a, fore = kLinks[2].a;
  const double square = point[0] * point[0] + point[1] * point[1];
  const auto bend = arc_cosine((square - upper * upper - fore * fore) / (2 * upper * fore));
  if (!bend) return;
  for (const double elbow : {*bend, -*bend}) {
    const double shoulder =
        std::atan2(point[1], point[0]) - std::atan2(fore * std::sin(elbow), upper + fore * std::cos(elbow));
    const Frame arm = compose(joint_frame(1, shoulder), joint_frame(2, elbow));
    const Frame rest = compose(inverse(arm), plane);
    nearest.offer({base, shoulder, elbow, std::atan2(rest.x[1], rest.x[0]), wrist_2, wrist_3});
  }
}

void offer_wrists(const Frame& flange, double base, Nearest& nearest) {
  const double s = std::sin(base), c = std::cos(base);
  const auto turn = arc_cosine((flange.origin[0] * s - flange.origin[1] * c - kLinks[3].d) / kLinks[5].d);
  if (!turn) return;
  for (const double wrist_2 : {*turn, -*turn}) {
    const double sine = std::sin(wrist_2);
    if (std::abs(sine) < kSingular) {
      // The last axis is parallel to the others: it may stay as it is.
      offer_elbows(flange, base, wrist_2, nearest.near()[5], nearest);
      continue;
    }
    const double wrist_3 =
        std::atan2((-flange.y[0] * s + flange.y[1] * c) / sine, (flange.x[0] * s - flange.x[1] * c) / sine);
    offer_elbows(flange, base, wrist_2, wrist_3, nearest);
  }
}

}  // namespace

std::optional<Joints> joints_for(const Frame& flange, const Joints& near) {
  const Vector wrist = sum(1, flange.origin, -kLinks[5].d, flange.z);
  const double far = std::hypot(wrist[0], wrist[1]);
  if (far < kSingular) return std::nullopt;
  const auto side = arc_cosine(kLinks[3].d / far);
  if (!side) return std::nullopt;
  Nearest nearest(near);
  for (const double turn : {*side, -*side}) {
    offer_wrists(flange, std::atan2(wrist[1], wrist[0]) + turn + kHalfTurn / 2, nearest);
  }
  return nearest.best();
}

}  // namespace trb::virtual_robots::ur
