#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "services/virtual-robots/support/pose.hpp"

namespace trb::virtual_robots::ros {

enum class Task { idle = 0, working = 1, failed = 2 };

/**
 * A mobile base with an arm, without ROS. It is driven by velocities, each valid for a short time, or to goals; the
 * arm's tasks drive it, too. All times are robot time in seconds, and never decrease.
 */
class Body {
 public:
  Body(const Pose& start, double battery_percent) : pose_(start), battery_(battery_percent) {}

  /** Holds until `until`, like a base's time-out for commands; ends a goal. */
  void drive(const Velocity& velocity, double now, double until);
  void go_to(const Pose& goal, double now);
  /** Drives to `from`, takes the box, drives to `to`, puts it down. */
  void fetch(const Pose& from, const Pose& to, double now);
  void load_out(double now);
  /** A task that cannot be begun, as its data are no poses: it has failed. */
  void refuse_task(double now);
  /** Stands still; a running task has failed. */
  void cancel(double now);
  /** Of the base: it stands and does not drive until cleared. Of the arm: its task fails, and no new one begins. */
  void fault(const std::string& text, double now);
  void arm_fault(const std::string& text, double now);
  /** A fault of the base, halfway to the next goal. */
  void fail_next_goal(const std::string& text) { next_goal_fault_ = text; }
  void clear();

  void advance(double now);

  const Pose& pose() const { return pose_; }
  const Velocity& velocity() const { return velocity_; }
  double battery_percent() const { return battery_; }
  void set_battery(double percent) { battery_ = percent; }
  Task task() const { return task_; }
  const std::string& fault_text() const { return fault_; }
  const std::string& arm_fault_text() const { return arm_fault_; }
  /** The arm's seven joints in radians: they sway while it works. */
  std::array<double, 7> joints() const;

 private:
  struct Leg {
    double seconds = 0;
    std::optional<Pose> goal;  // none: it stands while its arm works
  };
  void begin_task(std::vector<Leg> legs, double now);
  [[nodiscard]] bool can_do(const std::vector<Leg>& legs) const;
  void halt();
  void move(double seconds);
  void finish_leg(const Leg& leg);

  Pose pose_;
  Velocity velocity_;
  double battery_ = 100;
  double now_ = 0;
  std::optional<double> driven_until_;
  std::deque<Leg> legs_;
  double leg_left_ = 0;
  bool is_task_ = false;
  double arm_time_ = 0;
  Task task_ = Task::idle;
  std::string fault_;
  std::string arm_fault_;
  std::string next_goal_fault_;
};

}  // namespace trb::virtual_robots::ros
