#include "services/virtual-robots/ur/kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace trb::virtual_robots::ur {
namespace {

using Matrix = std::array<std::array<double, 6>, 6>;

constexpr double kRight = std::numbers::pi / 2;
constexpr double kFastestJoint = std::numbers::pi;  // rad/s
constexpr double kDamping = 1e-4;

Frame link_end(const Frame& frame, const Link& link, double joint) {
  const double c = std::cos(joint);
  const double s = std::sin(joint);
  const double ca = std::cos(link.alpha);
  const double sa = std::sin(link.alpha);
  Frame next;
  next.x = sum(c, frame.x, s, frame.y);
  const Vector across = sum(-s, frame.x, c, frame.y);
  next.y = sum(ca, across, sa, frame.z);
  next.z = sum(-sa, across, ca, frame.z);
  next.origin = sum(1, sum(1, frame.origin, link.a, next.x), link.d, frame.z);
  return next;
}

/** The frames of the foot and behind each joint. */
std::array<Frame, kJointCount + 1> frames_of(const Joints& joints) {
  std::array<Frame, kJointCount + 1> frames{};
  for (std::size_t i = 0; i < kJointCount; ++i) frames[i + 1] = link_end(frames[i], kLinks[i], joints[i]);
  return frames;
}

/** Column i: the twist of the flange when joint i turns by 1 rad/s. */
Matrix jacobian(const Joints& joints) {
  const auto frames = frames_of(joints);
  Matrix out{};
  for (std::size_t i = 0; i < kJointCount; ++i) {
    const Vector& axis = frames[i].z;
    const Vector moved = cross(axis, sum(1, frames[kJointCount].origin, -1, frames[i].origin));
    for (std::size_t k = 0; k < 3; ++k) {
      out[k][i] = moved[k];
      out[k + 3][i] = axis[k];
    }
  }
  return out;
}

/** Gauss's elimination; `left` is positive definite. */
Twist solve(Matrix left, Twist right) {
  for (std::size_t column = 0; column < 6; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column; row < 6; ++row) {
      if (std::abs(left[row][column]) > std::abs(left[pivot][column])) pivot = row;
    }
    std::swap(left[column], left[pivot]);
    std::swap(right[column], right[pivot]);
    for (std::size_t row = column + 1; row < 6; ++row) {
      const double factor = left[row][column] / left[column][column];
      for (std::size_t k = column; k < 6; ++k) left[row][k] -= factor * left[column][k];
      right[row] -= factor * right[column];
    }
  }
  for (std::size_t row = 6; row-- > 0;) {
    for (std::size_t k = row + 1; k < 6; ++k) right[row] -= left[row][k] * right[k];
    right[row] /= left[row][row];
  }
  return right;
}

}  // namespace

const std::array<Link, kJointCount> kLinks{{{0, 0.1519, kRight},
                                            {-0.24365, 0, 0},
                                            {-0.21325, 0, 0},
                                            {0, 0.11235, kRight},
                                            {0, 0.08535, -kRight},
                                            {0, 0.0819, 0}}};

Vector flange_of(const Joints& joints) {
  return frames_of(joints)[kJointCount].origin;
}

Frame flange_frame(const Joints& joints) {
  return frames_of(joints)[kJointCount];
}

Vector elbow_of(const Joints& joints) {
  return frames_of(joints)[2].origin;
}

Twist twist_of(const Joints& joints, const Joints& speeds) {
  const Matrix j = jacobian(joints);
  Twist out{};
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t i = 0; i < kJointCount; ++i) out[row] += j[row][i] * speeds[i];
  }
  return out;
}

Joints speeds_for(const Joints& joints, const Twist& twist) {
  const Matrix j = jacobian(joints);
  Matrix square{};  // J J' with damping, so that it can always be solved
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column) {
      for (std::size_t i = 0; i < kJointCount; ++i) square[row][column] += j[row][i] * j[column][i];
    }
    square[row][row] += kDamping * kDamping;
  }
  const Twist weights = solve(square, twist);
  Joints speeds{};
  double fastest = 0;
  for (std::size_t i = 0; i < kJointCount; ++i) {
    for (std::size_t row = 0; row < 6; ++row) speeds[i] += j[row][i] * weights[row];
    fastest = std::max(fastest, std::abs(speeds[i]));
  }
  if (fastest <= kFastestJoint) return speeds;
  for (double& speed : speeds) speed *= kFastestJoint / fastest;
  return speeds;
}

}  // namespace trb::virtual_robots::ur
