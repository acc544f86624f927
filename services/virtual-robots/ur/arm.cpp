#include "services/virtual-robots/ur/arm.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trb::virtual_robots::ur {
namespace {

/** How far the base sways in a motion to a pose, so that a watcher sees a motion. */
constexpr double kPoseSway = 0.001;
/** The step of a motion by speed, in seconds. */
constexpr double kStep = 0.004;

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
  from_ = to_ = at(now).position;
  speed_.reset();
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

double Arm::run(const SpeedStep& step, double now) {
  BySpeed& motion = by_speed(step.function == "speedl", now);
  motion.wanted = step.speeds;
  motion.acceleration = step.acceleration;
  return now + (step.time > 0 ? step.time : motion.time_to_wanted());
}

double Arm::brake(double acceleration, double now) {
  if (!speed_) return now;
  BySpeed& motion = by_speed(speed_->tool, now);
  motion.wanted = {};
  motion.acceleration = acceleration;
  return now + motion.time_to_wanted();
}

void Arm::halt(double now) {
  if (speed_) {
    brake(kProgramEnd, now);
    return;
  }
  const double done = fraction(now);
  from_ = to_ = at(now).position;
  pose_from_.values = pose_to_.values = between(pose_from_.values, pose_to_.values, done);
  sway_ = 0;
  begin_ = end_ = now;
}

void Arm::settle(double now) {
  if (speed_) speed_->advance(now);
}

/** The motion by speed, from where the arm is and as fast as it is. */
Arm::BySpeed& Arm::by_speed(bool tool, double now) {
  if (!speed_) {
    speed_ = BySpeed{};
    speed_->tool = tool;
    speed_->position = at_target(now).position;
    speed_->since = now;
  }
  speed_->advance(now);
  if (speed_->tool != tool) {
    const Joints joints = speed_->joint_speeds();
    speed_->speeds = tool ? twist_of(speed_->position, joints) : joints;
    speed_->tool = tool;
  }
  return *speed_;
}

Joints Arm::BySpeed::joint_speeds() const {
  return tool ? speeds_for(position, speeds) : speeds;
}

double Arm::BySpeed::time_to_wanted() const {
  double farthest = 0;
  for (std::size_t i = 0; i < speeds.size(); ++i) farthest = std::max(farthest, std::abs(wanted[i] - speeds[i]));
  return farthest / acceleration;
}

void Arm::BySpeed::advance(double now) {
  constexpr std::array<double, 6> kStill{};
  while (since < now && (speeds != kStill || wanted != kStill)) {
    const double step = std::min(now - since, kStep);
    const double left = time_to_wanted();
    const Joints before = joint_speeds();
    speeds = left <= step ? wanted : between(speeds, wanted, step / left);
    const Joints after = joint_speeds();
    for (std::size_t i = 0; i < kJointCount; ++i) position[i] += (before[i] + after[i]) / 2 * step;
    since += step;
  }
  since = std::max(since, now);
}

JointState Arm::at(double now) const {
  if (!speed_) return at_target(now);
  BySpeed motion = *speed_;
  motion.advance(now);
  return {motion.position, motion.position, motion.joint_speeds()};
}

JointState Arm::at_target(double now) const {
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
