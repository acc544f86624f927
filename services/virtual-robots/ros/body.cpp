#include "services/virtual-robots/ros/body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace trb::virtual_robots::ros {
namespace {

constexpr double kSpeed = 1.0;      // m/s
constexpr double kTurnSpeed = 2.0;  // rad/s
constexpr double kShortestWay = 0.2;
constexpr double kGrab = 1.0;
constexpr double kLoadOut = 2.0;
constexpr double kPercentPerSecond = 1.0 / 60;

double shortest_turn(double from, double to) {
  return std::remainder(to - from, 2 * M_PI);
}

double way_time(const Pose& from, const Pose& to) {
  const double way = std::hypot(to.x - from.x, to.y - from.y) / kSpeed;
  return std::max({way, std::abs(shortest_turn(from.yaw, to.yaw)) / kTurnSpeed, kShortestWay});
}

}  // namespace

void Body::drive(const Velocity& velocity, double now, double until) {
  advance(now);
  if (!fault_.empty()) return;
  halt();
  velocity_ = velocity;
  driven_until_ = until;
}

void Body::go_to(const Pose& goal, double now) {
  advance(now);
  if (!fault_.empty()) return;
  halt();
  legs_ = {{way_time(pose_, goal), goal}};
  if (!next_goal_fault_.empty()) {
    const Pose middle{(pose_.x + goal.x) / 2, (pose_.y + goal.y) / 2,
                      pose_.yaw + shortest_turn(pose_.yaw, goal.yaw) / 2};
    legs_ = {{way_time(pose_, goal) / 2, middle}};
  }
  leg_left_ = legs_.front().seconds;
}

void Body::fetch(const Pose& from, const Pose& to, double now) {
  begin_task({{way_time(pose_, from), from}, {kGrab, {}}, {way_time(from, to), to}, {kGrab, {}}}, now);
}

void Body::load_out(double now) {
  begin_task({{kLoadOut, {}}}, now);
}

void Body::refuse_task(double now) {
  cancel(now);
  task_ = Task::failed;
}

void Body::begin_task(std::vector<Leg> legs, double now) {
  advance(now);
  if (!can_do(legs)) {
    task_ = Task::failed;
    return;
  }
  halt();
  legs_.assign(legs.begin(), legs.end());
  leg_left_ = legs_.front().seconds;
  is_task_ = true;
  task_ = Task::working;
}

/** A broken base does not keep its arm from working. */
bool Body::can_do(const std::vector<Leg>& legs) const {
  const bool drives = std::any_of(legs.begin(), legs.end(), [](const Leg& leg) { return leg.goal.has_value(); });
  return arm_fault_.empty() && (fault_.empty() || !drives);
}

void Body::cancel(double now) {
  advance(now);
  halt();
}

void Body::fault(const std::string& text, double now) {
  cancel(now);
  fault_ = text;
}

void Body::arm_fault(const std::string& text, double now) {
  advance(now);
  if (is_task_) halt();
  arm_fault_ = text;
}

void Body::clear() {
  fault_.clear();
  arm_fault_.clear();
  next_goal_fault_.clear();
}

void Body::halt() {
  if (is_task_) task_ = Task::failed;
  is_task_ = false;
  legs_.clear();
  velocity_ = {};
  driven_until_.reset();
}

void Body::advance(double now) {
  while (now_ < now) {
    double step = now - now_;
    if (driven_until_) step = std::min(step, std::max(*driven_until_ - now_, 0.0));
    if (!legs_.empty()) step = std::min(step, leg_left_);
    move(step);
    now_ += step;
    if (driven_until_ && now_ >= *driven_until_) {
      velocity_ = {};
      driven_until_.reset();
    }
    if (!legs_.empty() && leg_left_ <= 0) {
      const Leg done = legs_.front();
      legs_.pop_front();
      finish_leg(done);
    }
    if (!driven_until_ && legs_.empty()) now_ = now;
  }
}

void Body::move(double seconds) {
  const bool works = driven_until_ || !legs_.empty();
  if (!works) return;
  battery_ = std::max(0.0, battery_ - seconds * kPercentPerSecond);
  if (driven_until_) {
    pose_.x += seconds * (velocity_.x * std::cos(pose_.yaw) - velocity_.y * std::sin(pose_.yaw));
    pose_.y += seconds * (velocity_.x * std::sin(pose_.yaw) + velocity_.y * std::cos(pose_.yaw));
    pose_.yaw = std::remainder(pose_.yaw + seconds * velocity_.turn, 2 * M_PI);
    return;
  }
  const Leg& leg = legs_.front();
  if (leg.goal) {
    const double part = leg_left_ > 0 ? std::min(seconds / leg_left_, 1.0) : 1.0;
    pose_.x += part * (leg.goal->x - pose_.x);
    pose_.y += part * (leg.goal->y - pose_.y);
    pose_.yaw += part * shortest_turn(pose_.yaw, leg.goal->yaw);
  } else {
    arm_time_ += seconds;
  }
  leg_left_ -= seconds;
}

void Body::finish_leg(const Leg& leg) {
  if (leg.goal) pose_ = *leg.goal;
  if (!legs_.empty()) {
    leg_left_ = legs_.front().seconds;
    return;
  }
  if (is_task_) {
    task_ = Task::idle;
  } else if (!next_goal_fault_.empty()) {
    fault_ = std::exchange(next_goal_fault_, {});
  }
  is_task_ = false;
}

std::array<double, 7> Body::joints() const {
  std::array<double, 7> joints{0, -0.5, 0, 1.2, 0, 0.9, 0};
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i] += 0.2 * std::sin(arm_time_ * (1.0 + double(i) / 7));
  return joints;
}

}  // namespace trb::virtual_robots::ros
