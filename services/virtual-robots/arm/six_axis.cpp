#include "services/virtual-robots/arm/six_axis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::arm {
namespace {

constexpr double kJointSpeed = 60;  ///< degrees a second
constexpr double kToolSpeed = 250;  ///< millimetres a second
constexpr double kShortest = 0.1;
constexpr double kGripTime = 0.5;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

double between(double from, double to, double fraction) {
  return from + (to - from) * fraction;
}

/** Base, upper arm and forearm of a small robot, in millimetres. */
Pose pose_of(const Joints& q) {
  constexpr double kBase = 400, kShoulder = 25, kUpper = 455, kFore = 500;
  const double shoulder = radians(-q[1]);
  const double elbow = shoulder - radians(q[2]);
  const double reach = kShoulder + kUpper * std::cos(shoulder) + kFore * std::cos(elbow);
  const double height = kBase + kUpper * std::sin(shoulder) + kFore * std::sin(elbow);
  const double turn = radians(q[0]);
  return {reach * std::cos(turn), reach * std::sin(turn), height, q[0], 90 - q[1] - q[2] - q[4], q[3] + q[5]};
}

double distance(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

}  // namespace

const Joints kHome{0, -90, 90, 0, 0, 0};

const Ranges kKukaRanges{{{-170, 170}, {-190, 45}, {-120, 156}, {-185, 185}, {-120, 120}, {-350, 350}}};
const Ranges kAbbRanges{{{-165, 165}, {-110, 110}, {-110, 70}, {-160, 160}, {-120, 120}, {-400, 400}}};

std::optional<std::string> out_of_range(const Joints& joints, const Ranges& ranges, char letter) {
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (joints[i] >= ranges[i].from && joints[i] <= ranges[i].to) continue;
    return letter + std::to_string(i + 1) + " " + format_fixed(joints[i], 1) + " is not in " +
           format_fixed(ranges[i].from, 1) + ".." + format_fixed(ranges[i].to, 1);
  }
  return std::nullopt;
}

std::vector<Step> pick_steps(const Joints& at) {
  return {at, Grip{true}, kHome};
}

std::vector<Step> grasp_and_put_down_steps(const Joints& at) {
  constexpr Joints kExit{23, -63, 75, 0, 78, 0};
  return {kExit, Grip{true}, at, Grip{false}, kHome};
}

void SixAxis::start(std::vector<Step> steps, double now) {
  halt(now);
  steps_ = std::move(steps);
  next_ = 0;
  if (!steps_.empty()) begin_step(now);
}

void SixAxis::halt(double now) {
  const Joints joints_now = joints(now);
  const Pose pose_now = pose(now);
  const bool in_pose = pose_to_.has_value();
  from_ = to_ = joints_now;
  pose_from_ = pose_to_ = in_pose ? std::optional(pose_now) : std::nullopt;
  begin_ = end_ = now;
  steps_.clear();
  paused_ = false;
}

void SixAxis::pause(double now) {
  if (paused_ || steps_.empty()) return;
  std::vector<Step> rest(steps_.begin() + static_cast<std::ptrdiff_t>(next_), steps_.end());
  halt(now);
  steps_ = std::move(rest);
  next_ = 0;
  paused_ = true;
}

void SixAxis::resume(double now) {
  if (!paused_) return;
  paused_ = false;
  begin_step(now);
}

/** Begins where the last one has ended, so that delays do not add up. */
void SixAxis::begin_step(double now) {
  begin_ = now;
  const Step& step = steps_[next_];
  if (const auto* target = std::get_if<Joints>(&step)) {
    double farthest = 0;
    for (std::size_t i = 0; i < kAxes; ++i) farthest = std::max(farthest, std::abs((*target)[i] - from_[i]));
    to_ = *target;
    pose_from_.reset();
    pose_to_.reset();
    end_ = now + std::max(kShortest, farthest / kJointSpeed);
  } else if (const auto* place = std::get_if<Pose>(&step)) {
    pose_from_ = pose(now);
    pose_to_ = *place;
    end_ = now + std::max(kShortest, distance(*pose_from_, *place) / kToolSpeed);
  } else if (const auto* grip = std::get_if<Grip>(&step)) {
    closed_ = grip->closed;
    end_ = now + kGripTime;
  } else {
    end_ = now + std::max(0.0, std::get<Pause>(step).seconds);
  }
}

bool SixAxis::advance(double now) {
  while (!steps_.empty() && !paused_ && now >= end_) {
    from_ = to_;
    if (pose_to_) pose_from_ = pose_to_;
    if (++next_ == steps_.size()) {
      steps_.clear();
      return true;
    }
    begin_step(end_);
  }
  return false;
}

std::optional<double> SixAxis::next_deadline() const {
  if (steps_.empty() || paused_) return std::nullopt;
  return end_;
}

double SixAxis::fraction(double now) const {
  if (paused_ || now >= end_ || end_ <= begin_) return paused_ ? 0.0 : 1.0;
  return std::max(0.0, (now - begin_) / (end_ - begin_));
}

Joints SixAxis::joints(double now) const {
  Joints out{};
  for (std::size_t i = 0; i < kAxes; ++i) out[i] = between(from_[i], to_[i], fraction(now));
  return out;
}

Pose SixAxis::pose(double now) const {
  if (!pose_to_ || !pose_from_) return pose_of(joints(now));
  const double f = fraction(now);
  const Pose& p = *pose_from_;
  const Pose& q = *pose_to_;
  return {between(p.x, q.x, f), between(p.y, q.y, f), between(p.z, q.z, f),
          between(p.a, q.a, f), between(p.b, q.b, f), between(p.c, q.c, f)};
}

}  // namespace trb::virtual_robots::arm
