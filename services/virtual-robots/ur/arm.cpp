#include "services/virtual-robots/ur/arm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace trb::virtual_robots::ur {
namespace {

/** The step of a motion by speed, in seconds. */
constexpr double kStep = 0.004;

template <typename Array>
Array between(const Array& from, const Array& to, double fraction) {
  Array result{};
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = from[i] + (to[i] - from[i]) * fraction;
  return result;
}

}  // namespace

bool Arm::start(const MoveStep& step, double now) {
  halt(now);
  const Joints from = at(now).position;
  speed_.reset();
  auto path = path_of(step, from, frame_of(tool_));
  path_ = path ? std::move(*path) : Path{{from}, 0};
  done_ = path ? 0 : 1;
  since_ = now;
  return path.has_value();
}

double Arm::end() const {
  if (done_ >= 1) return since_;
  if (scale_ <= 0) return std::numeric_limits<double>::infinity();
  return since_ + (1 - done_) * path_.duration / scale_;
}

void Arm::scale(double fraction_of_speed, double now) {
  done_ = fraction(now);
  since_ = std::max(since_, now);
  scale_ = std::clamp(fraction_of_speed, 0.0, 1.0);
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
  path_ = {{at(now).position}, 0};
  done_ = 1;
  since_ = now;
}

void Arm::settle(double now) {
  if (speed_) speed_->advance(now);
}

/** The motion by speed, from where the arm is and as fast as it is. */
Arm::BySpeed& Arm::by_speed(bool tool, double now) {
  if (!speed_) {
    speed_ = BySpeed{};
    speed_->tool = tool;
    speed_->position = at_path(now).position;
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
  if (!speed_) return at_path(now);
  BySpeed motion = *speed_;
  motion.advance(now);
  return {motion.position, motion.joint_speeds()};
}

JointState Arm::at_path(double now) const {
  const double done = fraction(now);
  if (done >= 1) return {path_.points.back(), {}};
  const std::size_t pieces = path_.points.size() - 1;
  const double place = done * static_cast<double>(pieces);
  const auto piece = std::min(static_cast<std::size_t>(place), pieces - 1);
  const Joints& from = path_.points[piece];
  const Joints& to = path_.points[piece + 1];
  JointState state{between(from, to, place - static_cast<double>(piece)), {}};
  const double pace = static_cast<double>(pieces) * scale_ / path_.duration;
  for (std::size_t i = 0; i < kJointCount; ++i) state.speed[i] = (to[i] - from[i]) * pace;
  return state;
}

double Arm::fraction(double now) const {
  if (done_ >= 1 || now >= end()) return 1.0;
  return done_ + std::max(0.0, now - since_) * scale_ / path_.duration;
}

}  // namespace trb::virtual_robots::ur
