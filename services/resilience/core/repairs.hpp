// A person says that a robot is repaired: its node is notified, and decides.
#pragma once

#include <string>
#include <vector>

#include "services/resilience/core/alerts.hpp"

namespace trb::resilience {

class Repairs {
 public:
  Repairs(Situation& situation, Alerts& alerts) : situation_(situation), alerts_(alerts) {}

  /// What only this node knows of is over at once; the rest when the robot's node says so. `why`: for the history.
  void begin(const Alert& alert, const std::string& why, Now now);
  /// Capabilities of which a person has said that they are repaired, and that the robot's node still has as broken.
  [[nodiscard]] std::vector<std::string> still_broken(const Alert& alert) const;
  /// True: the robot's node has not taken it into use yet, and is notified again; or it never will, and the alert is
  /// open again.
  [[nodiscard]] bool is_awaited(Alert& alert, Now now, Outbox& out);

  /// The robot's node has taken it into use: its profile is on its way.
  void on_taken(const std::string& robot, Now now);
  /// The robot's node refuses, or does not get, what it was sent.
  void on_refused(const Nack& nack, const std::string& from, Now now, Outbox& out);

 private:
  [[nodiscard]] static std::string why_failed(const Repair& repair, const std::vector<std::string>& broken, Now now);
  static void command(const Alert& alert, const std::vector<std::string>& broken, Outbox& out);

  Situation& situation_;
  Alerts& alerts_;
};

}  // namespace trb::resilience
