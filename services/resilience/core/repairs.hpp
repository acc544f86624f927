// A person reports that a robot is repaired: its node is notified, and decides.
#pragma once

#include <string>
#include <vector>

#include "services/resilience/core/alert_lifecycle.hpp"

namespace trb::resilience {

class Repairs {
 public:
  Repairs(Situation& situation, AlertLifecycle& alerts) : situation_(situation), alerts_(alerts) {}

  /// Ends at once the faults that only this node knows; the others when the robot's node reports it. `why`: for the
  /// history.
  void begin(const Alert& alert, const std::string& why, Now now);
  /// Capabilities that a person has reported as repaired, and that the robot's node still reports as broken.
  [[nodiscard]] std::vector<std::string> still_broken(const Alert& alert) const;
  /// True: the robot's node has not taken it into use yet, and is notified again; or it refused, and the alert is open
  /// again.
  [[nodiscard]] bool is_awaited(Alert& alert, Now now, Outbox& out);

  /// The robot's node has taken it into use: its profile follows.
  void on_taken(const std::string& robot, Now now);
  /// The robot's node refuses the message, or did not get it.
  void on_refused(const Nack& nack, const std::string& from, Now now, Outbox& out);

 private:
  [[nodiscard]] static std::string why_failed(const RepairReport& repair, const std::vector<std::string>& broken,
                                              Now now);
  static void command(const Alert& alert, const std::vector<std::string>& broken, Outbox& out);

  Situation& situation_;
  AlertLifecycle& alerts_;
};

}  // namespace trb::resilience
