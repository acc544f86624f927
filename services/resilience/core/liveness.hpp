// Which robots are gone as a whole: their node is not reached, or the robot itself is not connected, for longer than a
// grace period.
#pragma once

#include <map>
#include <string>

#include "services/resilience/core/fleet.hpp"

namespace trb::resilience {

class Liveness {
 public:
  static constexpr Duration kGrace = std::chrono::seconds(5);

  struct Gone {
    MonotonicTime since;
    std::string cause;  ///< "peer_expired" or "robot_connection"
    std::string text;
  };

  /// The router's table has come: before that no robot is judged.
  void begin() { begun_ = true; }
  /// Checks the robot; nullptr: the fleet does not know it. `expired`: the router has just reported that its lease has
  /// run out, which counts as the grace period.
  void look(const std::string& id, const RobotRecord* robot, Now now, bool expired = false);
  /// nullptr: it is there, or has not been away for the grace period.
  [[nodiscard]] const Gone* find(std::string_view id, Now now) const;
  /// When that robot's grace period ends; nothing: it is there, or is gone already.
  [[nodiscard]] std::optional<MonotonicTime> next(std::string_view id, Now now) const;
  /// When the next robot's grace period ends.
  [[nodiscard]] std::optional<MonotonicTime> next(Now now) const;

 private:
  std::map<std::string, Gone, std::less<>> away_;
  bool begun_ = false;
};

}  // namespace trb::resilience
