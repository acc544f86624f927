#include "services/virtual-robots/pioneer/drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trb::virtual_robots::pioneer {
namespace {

constexpr double kStep = 0.002;  // seconds
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kHard = 5;  // how much harder an emergency stop brakes

double between(double from, double to) {
  return std::remainder(to - from, 2 * std::numbers::pi);
}

/** The next speed on the way to the wanted one. */
double approach(double speed, double wanted, const Drive::Limits& limits, double seconds) {
  const bool brakes = std::abs(wanted) < std::abs(speed) || wanted * speed < 0;
  const double change = (brakes ? limits.deceleration : limits.acceleration) * seconds;
  return speed + std::clamp(wanted - speed, -change, change);
}

/** The speed at which a servo approaches a goal: it can still stop there. */
double nearing(double left, const Drive::Limits& limits) {
  return std::copysign(std::min(limits.speed, std::sqrt(2 * limits.deceleration * std::abs(left))), left);
}

Drive::Limits scaled(const Drive::Limits& limits, double factor) {
  return {limits.speed * factor, limits.acceleration * factor, limits.deceleration * factor};
}

}  // namespace

void Drive::set_speed(double speed) {
  way_left_.reset();
  hard_ = false;
  wanted_speed_ = std::clamp(speed, -drive_limits.speed, drive_limits.speed);
}

void Drive::move(double way) {
  hard_ = false;
  wanted_speed_ = 0;
  way_left_ = way;
}

void Drive::set_turn(double degrees_per_s) {
  turn_goal_.reset();
  hard_ = false;
  wanted_turn_ = std::clamp(degrees_per_s, -turn_limits.speed, turn_limits.speed) * kDegree;
}

void Drive::turn_to(double degrees) {
  hard_ = false;
  wanted_turn_ = 0;
  turn_goal_ = degrees * kDegree;
}

double Drive::heading_goal() const {
  return turn_goal_.value_or(position_.heading) / kDegree;
}

void Drive::stop(bool hard) {
  way_left_.reset();
  turn_goal_.reset();
  wanted_speed_ = wanted_turn_ = 0;
  hard_ = hard;
}

void Drive::block() {
  stop(false);
  speed_ = turn_ = 0;
}

void Drive::advance(double seconds) {
  while (seconds > 0) {
    step(std::min(seconds, kStep));
    seconds -= kStep;
  }
}

void Drive::step(double seconds) {
  const double force = hard_ ? kHard : 1;
  const Limits drive = scaled(drive_limits, force);
  const Limits turn = scaled(turn_limits, kDegree * force);
  const double turn_left = turn_goal_ ? between(position_.heading, *turn_goal_) : 0;
  const double wanted_speed = held_ ? 0 : way_left_ ? nearing(*way_left_, drive) : wanted_speed_;
  const double wanted_turn = held_ ? 0 : turn_goal_ ? nearing(turn_left, turn) : wanted_turn_;
  speed_ = approach(speed_, wanted_speed, drive, seconds);
  turn_ = approach(turn_, wanted_turn, turn, seconds);
  const double way = speed_ * seconds;
  const double middle = position_.heading + turn_ * seconds / 2;
  position_.x += way * std::cos(middle);
  position_.y += way * std::sin(middle);
  position_.heading = std::remainder(position_.heading + turn_ * seconds, 2 * std::numbers::pi);
  if (way_left_ && std::abs(*way_left_ -= way) < 0.3 && std::abs(speed_) < 40) {
    way_left_.reset();
    speed_ = 0;
  }
  if (turn_goal_ && std::abs(between(position_.heading, *turn_goal_)) < 0.2 * kDegree &&
      std::abs(turn_) < 10 * kDegree) {
    turn_goal_.reset();
    turn_ = 0;
  }
}

}  // namespace trb::virtual_robots::pioneer
