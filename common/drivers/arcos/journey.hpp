// Drives to a place with a robot that can only turn to a heading (HEAD) and drive straight on (MOVE): turn towards the
// goal, drive, check where it is, repeat if it is not near enough; finally turn to the heading.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/time.hpp"

namespace trb::drivers {

/// Millimetres and degrees of the robot's own frame.
struct ArcosPose {
  double x = 0;
  double y = 0;
  double heading = 0;
};

struct ArcosGoal {
  double x = 0;
  double y = 0;
  std::optional<double> heading;
  double tolerance = 50;
  double angle = 3;
};

/// on_pose() | leg    | the robot stands …                  | then
/// ----------|--------|-------------------------------------|---------------------------------------------
///           | none   | anywhere                            | the next leg
///           | turn   | towards the goal                    | the next leg
///           | drive  | somewhere else than at the leg's begin | the next leg
///           | face   | at the heading                      | over: arrived
///           | any    | as it has for 3 s                   | over: no progress
class ArcosJourney {
 public:
  explicit ArcosJourney(const ArcosGoal& goal) : goal_(goal) {}

  struct Next {
    Bytes packet;  ///< to the robot; may be empty
    bool over = false;
    std::string failure;  ///< if over: why it has not arrived; empty: arrived
  };
  /// After each of the robot's packets.
  Next on_pose(const ArcosPose& pose, bool stands, MonotonicTime now);

 private:
  enum class Leg : std::uint8_t { none, turn, drive, face };

  Next begin_leg(const ArcosPose& pose, MonotonicTime now);
  Next turn(Leg leg, double heading, const ArcosPose& pose, MonotonicTime now);
  void start(Leg leg, const ArcosPose& pose, MonotonicTime now);
  [[nodiscard]] bool done(const ArcosPose& pose) const;
  void note_progress(const ArcosPose& pose, MonotonicTime now);
  [[nodiscard]] Next fail(const std::string& why, const ArcosPose& pose) const;

  ArcosGoal goal_;
  Leg leg_ = Leg::none;
  double towards_ = 0;  ///< the heading of a turn
  int legs_left_ = 0;
  ArcosPose began_;  ///< where the leg began
  MonotonicTime leg_began_;
  ArcosPose progress_;  ///< the last position that counted as progress
  MonotonicTime progressed_;
};

}  // namespace trb::drivers
