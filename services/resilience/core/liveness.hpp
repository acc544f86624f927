// Which robots are gone as a whole: their node is not reached, or the robot itself is not there, for longer than a
// grace.
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

  /// The router's table has come: before, nobody is judged.
  void begin() { begun_ = true; }
  /// Looks at the robot, nullptr: the fleet does not know it. `expired`: the router has just said that its lease has
  /// run out, which was grace enough.
  void look(const std::string& id, const RobotRecord* robot, Now now, bool expired = false);
  /// nullptr: it is there, or has not been away for long.
  [[nodiscard]] const Gone* find(std::string_view id, Now now) const;
  /// When that robot has been away for the grace; nothing: it is there, or is gone already.
  [[nodiscard]] std::optional<MonotonicTime> next(std::string_view id, Now now) const;
  /// When the next one has been.
  [[nodiscard]] std::optional<MonotonicTime> next(Now now) const;

 private:
  std::map<std::string, Gone, std::less<>> away_;
  bool begun_ = false;
};

}  // namespace trb::resilience
