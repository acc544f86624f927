#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace trb::virtual_robots::arm {

constexpr std::size_t kAxes = 6;

/** Six joints in degrees. */
using Joints = std::array<double, kAxes>;

/** The flange: millimetres, and degrees about Z, Y, X. */
struct Pose {
  double x = 0, y = 0, z = 0, a = 0, b = 0, c = 0;
};

/** A step of a motion: to joints, to a pose, the gripper, or a pause in seconds. */
struct Grip {
  bool closed = false;
};
struct Pause {
  double seconds = 0;
};
using Step = std::variant<Joints, Pose, Grip, Pause>;

struct Range {
  double from, to;
};
using Ranges = std::array<Range, kAxes>;
extern const Ranges kKukaRanges;
extern const Ranges kAbbRanges;

/** The joint that is out of its range, as "A2 60.0 is not in -190.0..45.0"; `letter`: the maker's name of an axis.
 */
std::optional<std::string> out_of_range(const Joints& joints, const Ranges& ranges = kKukaRanges, char letter = 'A');

/** The steps of fetching, putting down and leaving, the same for every virtual arm. */
std::vector<Step> pick_steps(const Joints& at);
std::vector<Step> grasp_and_put_down_steps(const Joints& at);
extern const Joints kHome;

/**
 * An arm of six axes that carries out steps one after the other, straight in time. `now` is robot time in seconds.
 * The pose follows from the first three joints; the joints do not follow from a pose.
 */
class SixAxis {
 public:
  explicit SixAxis(const Joints& at = kHome) : from_(at), to_(at) {}

  /** Replaces the previous steps. */
  void start(std::vector<Step> steps, double now);
  /** Stands still where it is; the remaining steps are dropped. */
  void halt(double now);
  /** Stands still, and goes on with the same steps after resume. */
  void pause(double now);
  void resume(double now);

  /** Carries out what is due. True: the last step ended in this call. */
  bool advance(double now);
  std::optional<double> next_deadline() const;

  bool moving() const { return !steps_.empty(); }
  bool paused() const { return paused_; }
  bool gripper_closed() const { return closed_; }
  Joints joints(double now) const;
  Pose pose(double now) const;

 private:
  void begin_step(double now);
  double fraction(double now) const;

  std::vector<Step> steps_;
  std::size_t next_ = 0;  ///< the step under way
  Joints from_;
  Joints to_;
  std::optional<Pose> pose_from_;
  std::optional<Pose> pose_to_;
  double begin_ = 0;
  double end_ = 0;
  bool paused_ = false;
  bool closed_ = false;
};

}  // namespace trb::virtual_robots::arm
