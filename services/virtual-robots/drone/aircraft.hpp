#pragma once

#include <cstdint>

namespace trb::virtual_robots::drone {

/** The aircraft's phase, numbered as in the maker's navdata. */
enum class Phase : std::uint8_t { cut = 0, landed = 2, flying = 3, hovering = 4, taking_off = 6, landing = 8 };

/** Fractions of the largest tilt or speed, -1 to 1, as in PCMD: forward is a negative pitch, right and up positive.
 */
struct Stick {
  double roll = 0;
  double pitch = 0;
  double gaz = 0;
  double yaw = 0;
  bool operator==(const Stick&) const = default;
};

/** The body of a quadrocopter: a velocity that follows the stick and is braked when it hovers, a battery that drains.
   Axes forward, right, up. */
class Aircraft {
 public:
  static constexpr double kLowBattery = 20;   ///< percent: it no longer takes off
  static constexpr double kEmptyBattery = 4;  ///< it lands by itself
  static constexpr double kHoverHeight_m = 0.8;
  static constexpr double kLargestTilt_rad = 0.21;  ///< 12 degrees

  /** From the ground, or during a landing. False when the battery is low or the motors are cut. */
  bool take_off();
  void land();
  void cut_motors();
  /** Puts it on the ground after its motors were cut. */
  void restore();
  /** Without a stick command it hovers. */
  void steer(const Stick& stick) { stick_ = stick; }
  void set_battery(double percent) { battery_ = percent; }
  void set_ceiling(double metres) { ceiling_ = metres; }

  /** Lets time pass, in the aircraft's seconds. */
  void advance(double seconds);

  Phase phase() const;
  bool in_air() const { return phase_ != Phase::landed && phase_ != Phase::cut; }
  bool battery_low() const { return battery_ < kLowBattery; }
  double battery() const { return battery_; }
  double x() const { return x_; }
  double y() const { return y_; }
  double altitude() const { return z_; }
  double heading() const { return heading_; }  ///< radians, clockwise
  double forward_speed() const { return forward_; }
  double right_speed() const { return right_; }
  double down_speed() const { return 0 - climb_; }
  double roll() const { return stick_.roll * kLargestTilt_rad; }
  double pitch() const { return stick_.pitch * kLargestTilt_rad; }

 private:
  void step(double seconds);
  void fly(double seconds);
  void drain(double seconds);

  Phase phase_ = Phase::landed;  ///< never Hovering: that is Flying without a stick command
  Stick stick_;
  double ceiling_ = 3;
  double battery_ = 100;
  double x_ = 0, y_ = 0, z_ = 0, heading_ = 0;
  double forward_ = 0, right_ = 0, climb_ = 0;
};

}  // namespace trb::virtual_robots::drone
