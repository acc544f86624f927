#pragma once

#include <optional>

#include "services/virtual-robots/ur/kinematics.hpp"
#include "services/virtual-robots/ur/script.hpp"

namespace trb::virtual_robots::ur {

/** The joints' state at one moment. */
struct JointState {
  Joints position{};
  Joints target{};
  Joints speed{};
};

/**
 * The motion of six joints: to a target, a straight line in time; or by speed, with an acceleration. A tool's speed is
 * turned into the joints' by the arm's kinematics; a target that is a pose is only remembered.
 */
class Arm {
 public:
  static constexpr double kDefaultJointSpeed = 1.05;
  static constexpr double kShortestJointMove = 0.1;
  static constexpr double kDefaultToolSpeed = 0.25;
  static constexpr double kShortestToolMove = 0.2;
  /** How the arm brakes when its program ends while it moves by speed. */
  static constexpr double kProgramEnd = 4;

  /** Starts a motion and returns when it ends. */
  double start(const MoveStep& step, double now);

  /** Accelerates to a speed from the present one; returns when the function returns: the arm goes on. */
  double run(const SpeedStep& step, double now);

  /** Brakes; returns when the arm stands. */
  double brake(double acceleration, double now);

  /** The program ends. A motion to a target stands still where it is, one by speed brakes. */
  void halt(double now);

  /** What is before `now` needs not be reckoned again. */
  void settle(double now);

  JointState at(double now) const;

 private:
  /** A motion by speed: of the joints, or of the tool. */
  struct BySpeed {
    bool tool = false;
    Joints position{};
    std::array<double, 6> speeds{};
    std::array<double, 6> wanted{};
    double acceleration = kProgramEnd;
    double since = 0;

    void advance(double now);
    double time_to_wanted() const;
    Joints joint_speeds() const;
  };

  void start_joints(const Joints& target, const MoveStep& step, double now);
  void start_pose(const Pose& target, const MoveStep& step, double now);
  double fraction(double now) const;
  JointState at_target(double now) const;
  BySpeed& by_speed(bool tool, double now);

  Joints from_{0.0, -1.5708, 0.0, -1.5708, 0.0, 0.0};
  Joints to_ = from_;
  Pose pose_from_;
  Pose pose_to_;
  double sway_ = 0;
  double begin_ = 0;
  double end_ = 0;
  std::optional<BySpeed> speed_;  ///< goes before the motion to a target
};

}  // namespace trb::virtual_robots::ur
