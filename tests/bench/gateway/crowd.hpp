// The robots that the feeder plays: who they are, and what each of their changes says.
#pragma once

#include "common/base/time.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/robot.hpp"

namespace trb::bench {

/// Robots that drive in circles, each `changes` times a second, spread evenly over the time between two changes.
class Crowd {
 public:
  Crowd(int robots, double changes, MonotonicTime begin);

  /// A change: the robot, its number from 1, and when it is due.
  struct Change {
    int robot = 0;
    std::uint64_t number = 0;
    MonotonicTime due;
  };
  /// The next change if it is due.
  bool take(MonotonicTime now, Change& out);
  [[nodiscard]] MonotonicTime next_due() const { return due(taken_); }
  [[nodiscard]] int size() const { return robots_; }

  static std::string name(int robot);
  static NodeProfile profile(int robot);
  /// Its value "said" is "ROBOT NUMBER DUE": a page reads from it which change that is, and how old. DUE is in us of
  /// the monotonic clock.
  static RobotState state(const Change& change);
  /// "X Y YAW", as a robot answers when it is asked where it is.
  static std::string position(int robot, std::uint64_t number);

 private:
  [[nodiscard]] MonotonicTime due(std::uint64_t index) const;

  int robots_;
  double between_ns_;  ///< of two changes, of any robots
  MonotonicTime begin_;
  std::uint64_t taken_ = 0;
};

}  // namespace trb::bench
