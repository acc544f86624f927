#pragma once

#include <limits>
#include <optional>

#include "services/virtual-robots/support/process.hpp"

namespace trb::virtual_robots {

/** A robot's own time, in seconds since its start: it runs `speed` times as fast as the steady clock. */
class RobotClock {
 public:
  explicit RobotClock(double speed) : speed_(speed) {}

  double now() const { return (wall_seconds() - begin_) * speed_; }
  /** The robot time `step` in seconds of the steady clock; never, without one. */
  double deadline(std::optional<double> step) const {
    return step ? begin_ + *step / speed_ : std::numeric_limits<double>::infinity();
  }
  double begin() const { return begin_; }

 private:
  double speed_;
  double begin_ = wall_seconds();
};

}  // namespace trb::virtual_robots
