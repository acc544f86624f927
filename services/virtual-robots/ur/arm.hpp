#pragma once

#include "services/virtual-robots/ur/script.hpp"

namespace trb::virtual_robots::ur {

/** The joints' state at one moment. */
struct JointState {
  Joints position{};
  Joints target{};
  Joints speed{};
};

/** The motion of six joints, a straight line in time. It has no kinematics: a pose is only remembered. */
class Arm {
 public:
  static constexpr double kDefaultJointSpeed = 1.05;
  static constexpr double kShortestJointMove = 0.1;
  static constexpr double kDefaultToolSpeed = 0.25;
  static constexpr double kShortestToolMove = 0.2;

  /** Starts a motion and returns when it ends. */
  double start(const MoveStep& step, double now);

  /** Stands still where it is. */
  void halt(double now);

  JointState at(double now) const;

 private:
  void start_joints(const Joints& target, const MoveStep& step, double now);
  void start_pose(const Pose& target, const MoveStep& step, double now);
  double fraction(double now) const;

  Joints from_{0.0, -1.5708, 0.0, -1.5708, 0.0, 0.0};
  Joints to_ = from_;
  Pose pose_from_;
  Pose pose_to_;
  double sway_ = 0;
  double begin_ = 0;
  double end_ = 0;
};

}  // namespace trb::virtual_robots::ur
