#include "services/virtual-robots/ur/arm.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trb::virtual_robots::ur {
namespace {

/** How far the base sways in a motion to a pose, so that a watcher sees a motion. */
constexpr double kPoseSway = 0.001;

double move_duration(double distance, const MoveStep& step, double default_speed, double shortest) {
  if (step.time > 0) return std::max(step.time, shortest);
  return std::max(distance / (step.speed > 0 ? step.speed : default_speed), shortest);
}

template <typename Array>
Array between(const Array& from, const Array& to, double fraction) {
  Array result{};
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = from[i] + (to[i] - from[i]) * fraction;
  return result;
}

double distance(const Pose& a, const Pose& b) {
  return std::hypot(a.values[0] - b.values[0], a.values[1] - b.values[1], a.values[2] - b.values[2]);
}

}  // namespace

double Arm::start(const MoveStep& step, double now) {
  halt(now);
  begin_ = now;
  if (const auto* joints = std::get_if<Joints>(&step.target)) {
    start_joints(*joints, step, now);
  } else {
    start_pose(std::get<Pose>(step.target), step, now);
  }
  return end_;
}

void Arm::start_joints(const Joints& target, const MoveStep& step, double now) {
  double farthest = 0;
  for (std::size_t i = 0; i < kJointCount; ++i) farthest = std::max(farthest, std::abs(target[i] - from_[i]));
  to_ = target;
  end_ = now + move_duration(farthest, step, kDefaultJointSpeed, kShortestJointMove);
}

void Arm::start_pose(const Pose& target, const MoveStep& step, double now) {
  pose_to_ = target;
  sway_ = kPoseSway;
  end_ = now + move_duration(distance(pose_from_, target), step, kDefaultToolSpeed, kShortestToolMove);
}

void Arm::halt(double now) {
  const double done = fraction(now);
  from_ = to_ = at(now).position;
  pose_from_.values = pose_to_.values = between(pose_from_.values, pose_to_.values, done);
  sway_ = 0;
  begin_ = end_ = now;
}

JointState Arm::at(double now) const {
  const double done = fraction(now);
  JointState state{between(from_, to_, done), to_, {}};
  if (done >= 1.0) return state;
  const double duration = end_ - begin_;
  for (std::size_t i = 0; i < kJointCount; ++i) state.speed[i] = (to_[i] - from_[i]) / duration;
  const double angle = std::numbers::pi * done;
  state.position[0] += sway_ * std::sin(angle);
  state.speed[0] += sway_ * std::cos(angle) * std::numbers::pi / duration;
  return state;
}

double Arm::fraction(double now) const {
  if (end_ <= begin_ || now >= end_) return 1.0;
  return std::max(0.0, (now - begin_) / (end_ - begin_));
}

}  // namespace trb::virtual_robots::ur
