#pragma once

#include <optional>

#include "services/virtual-robots/ur/path.hpp"

namespace trb::virtual_robots::ur {

/** The joints' state at one moment. The arm follows its trajectory exactly: what it should do is what it does. */
struct JointState {
  Joints position{};
  Joints speed{};
};

/**
 * The motion of six joints: to a target, along a path, evenly in time; or by speed, with an acceleration. A tool's
 * speed is turned into the joints' by the arm's kinematics.
 */
class Arm {
 public:
  /** How the arm brakes when its program ends while it moves by speed. */
  static constexpr double kProgramEnd = 4;

  /** Starts a motion. False: out of reach, the arm stands still. */
  bool start(const MoveStep& step, double now);

  /** When the motion to a target ends; infinite while the speed slider is at 0. */
  double end() const;

  /** The speed slider, 0 to 1, scales motions to a target. */
  void scale(double fraction, double now);

  void set_tool(const Pose& tool) { tool_ = tool; }
  const Pose& tool() const { return tool_; }

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

  double fraction(double now) const;
  JointState at_path(double now) const;
  BySpeed& by_speed(bool tool, double now);

  Path path_{{{0.0, -1.5708, 0.0, -1.5708, 0.0, 0.0}}, 0};
  Pose tool_;
  double done_ = 1;  ///< the part of the path that was done at `since_`
  double since_ = 0;
  double scale_ = 1;
  std::optional<BySpeed> speed_;  ///< goes before the motion to a target
};

}  // namespace trb::virtual_robots::ur
