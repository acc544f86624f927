// Who is connected to a topic that the worker publishes, and whether somebody is still to come.
#pragma once

#include <chrono>
#include <optional>
#include <set>
#include <string>

namespace trb::ros {

/// ROS connects a topic's subscribers one by one. Who is connected first may be a recorder, and what is published then
/// would be lost to the robot.
class Receivers {
 public:
  /// A node has been connected; the worker's own, which is no robot, is passed over.
  void add(const std::string& node);
  void remove(const std::string& node);
  [[nodiscard]] bool empty() const { return connected_.empty(); }
  /// True if somebody is connected, and so is each node that the ROS master names; or 500 ms later, for a node that has
  /// crashed is named, too. It asks the master, but only what was not asked since a node went.
  bool are_complete(const std::string& topic);

 private:
  using Clock = std::chrono::steady_clock;

  std::multiset<std::string> connected_;  ///< by name; one that connects anew comes before it goes
  std::set<std::string> awaited_;
  std::optional<Clock::time_point> complete_by_;
};

}  // namespace trb::ros
