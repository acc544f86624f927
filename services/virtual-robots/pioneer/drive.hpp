#pragma once

#include <optional>

namespace trb::virtual_robots::pioneer {

/** Millimetres and radians, counter-clockwise. */
struct Position {
  double x = 0;
  double y = 0;
  double heading = 0;
};

/**
 * The motion of two driven wheels, with limits of speed and acceleration. Driving and turning are two servos, each with
 * a setpoint of its own: a speed, or a distance (angle) still to go. Time is in seconds.
 */
class Drive {
 public:
  struct Limits {
    double speed = 750;         ///< mm/s
    double acceleration = 300;  ///< mm/s^2
    double deceleration = 300;
  };

  void set_speed(double speed);
  void move(double way);
  void set_turn(double degrees_per_s);
  void turn_to(double degrees);
  void turn_by(double degrees) { turn_to(heading_goal() + degrees); }

  /** Ends both setpoints and brakes; `hard`: as fast as the wheels can. */
  void stop(bool hard);
  /** Stops at once: stalled, or the motors are off. */
  void block();
  /** While held the robot brakes and stands, its setpoints are kept. */
  void hold(bool held) { held_ = held; }
  /** The robot reports 0, 0, 0 here from now on. */
  void set_origin() { position_ = {}; }

  void advance(double seconds);

  const Position& position() const { return position_; }
  double speed() const { return speed_; }  ///< mm/s
  double turn() const { return turn_; }    ///< radians/s
  bool is_still() const { return speed_ == 0 && turn_ == 0; }

  Limits drive_limits;
  Limits turn_limits{100, 100, 100};  ///< degrees

 private:
  double heading_goal() const;
  void step(double seconds);

  Position position_;
  double speed_ = 0;
  double turn_ = 0;
  double wanted_speed_ = 0;
  double wanted_turn_ = 0;           ///< radians/s
  std::optional<double> way_left_;   ///< mm; has priority over the wanted speed
  std::optional<double> turn_goal_;  ///< radians; has priority over the wanted turn
  bool held_ = false;
  bool hard_ = false;
};

}  // namespace trb::virtual_robots::pioneer
