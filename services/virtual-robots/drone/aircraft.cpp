#include "services/virtual-robots/drone/aircraft.hpp"

#include <algorithm>
#include <cmath>

namespace trb::virtual_robots::drone {
namespace {

constexpr double kStep_s = 0.02;
constexpr double kFastest_m_s = 3;
constexpr double kClimb_m_s = 0.7;
constexpr double kTakeOff_m_s = 0.4;
constexpr double kLanding_m_s = 0.4;
constexpr double kTurn_rad_s = 1.75;
constexpr double kFollows_s = 0.3;
constexpr double kGravity = 9.81;
constexpr double kFlightTime_s = 720;
constexpr double kIdleTime_s = 7200;

double towards(double value, double target, double seconds) {
  return value + (target - value) * std::min(1.0, seconds / kFollows_s);
}

/// Hovering is holding a place: it tilts against its motion, as far as it may, until it stands.
double brake(double speed, double seconds) {
  static const double kBrake_m_s2 = kGravity * std::tan(Aircraft::kLargestTilt_rad);
  return std::copysign(std::max(0.0, std::abs(speed) - kBrake_m_s2 * seconds), speed);
}

}  // namespace

bool Aircraft::take_off() {
  if (phase_ == Phase::landing) {
    phase_ = z_ < kHoverHeight_m ? Phase::taking_off : Phase::flying;
  } else if (phase_ == Phase::landed) {
    if (battery_low()) return false;
    phase_ = Phase::taking_off;
  }
  return phase_ != Phase::cut;
}

void Aircraft::land() {
  if (in_air()) phase_ = Phase::landing;
}

void Aircraft::cut_motors() {
  phase_ = Phase::cut;
  stick_ = {};
}

void Aircraft::restore() {
  if (phase_ == Phase::cut) phase_ = Phase::landed;
}

Phase Aircraft::phase() const {
  return phase_ == Phase::flying && stick_ == Stick{} ? Phase::hovering : phase_;
}

void Aircraft::advance(double seconds) {
  // After a pause of an hour the process need not compute each step of the flight.
  double left = std::clamp(seconds, 0.0, 600.0);
  while (left > 0) {
    const double next = std::min(left, kStep_s);
    step(next);
    left -= next;
  }
}

void Aircraft::step(double seconds) {
  drain(seconds);
  if (phase_ == Phase::landed) {
    forward_ = right_ = climb_ = 0;
    return;
  }
  fly(seconds);
  x_ += (forward_ * std::cos(heading_) - right_ * std::sin(heading_)) * seconds;
  y_ += (forward_ * std::sin(heading_) + right_ * std::cos(heading_)) * seconds;
  z_ = std::clamp(z_ + climb_ * seconds, 0.0, std::max(ceiling_, kHoverHeight_m));
  if (phase_ == Phase::taking_off && z_ >= kHoverHeight_m) phase_ = Phase::flying;
  if (phase_ == Phase::landing && z_ <= 0) phase_ = Phase::landed;
  if (phase_ == Phase::cut && z_ <= 0) forward_ = right_ = climb_ = 0;
}

void Aircraft::fly(double seconds) {
  const bool steered = phase() == Phase::flying;
  forward_ = steered ? towards(forward_, -stick_.pitch * kFastest_m_s, seconds) : brake(forward_, seconds);
  right_ = steered ? towards(right_, stick_.roll * kFastest_m_s, seconds) : brake(right_, seconds);
  if (phase_ == Phase::flying) {
    climb_ = steered ? towards(climb_, stick_.gaz * kClimb_m_s, seconds) : brake(climb_, seconds);
    heading_ = std::remainder(heading_ + stick_.yaw * kTurn_rad_s * seconds, 2 * M_PI);
  } else if (phase_ == Phase::cut) {
    climb_ -= kGravity * seconds;
  } else {
    climb_ = phase_ == Phase::taking_off ? kTakeOff_m_s : -kLanding_m_s;
  }
}

void Aircraft::drain(double seconds) {
  battery_ = std::max(0.0, battery_ - 100 * seconds / (in_air() ? kFlightTime_s : kIdleTime_s));
  if (battery_ < kEmptyBattery) land();
}

}  // namespace trb::virtual_robots::drone
