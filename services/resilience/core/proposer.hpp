// Keeps an open alert's proposals in step with what is known, and asks the robots for what is not.
#pragma once

#include <string>

#include "services/resilience/core/alerts.hpp"

namespace trb::resilience {

class Proposer {
 public:
  Proposer(Situation& situation, Alerts& alerts) : situation_(situation), alerts_(alerts) {}

  /// Makes the alert's proposals anew. The run is_known().
  void propose(Alert& alert, const WatchedRun& run, Now now);
  /// Requests what counts of whoever is proposed, or would be but for a bound, if it is not known or old.
  void ask_values(const Alert& alert, Now now, Outbox& out);
  /// Asks and proposes anew what was not yet since the start, what is stale, and what nobody could do.
  void refresh(Alert& alert, const WatchedRun& run, Now now, Outbox& out);
  /// The proposals follow the values that have come.
  void follow_answers(Alert& alert, Now now, Outbox& out);
  /// Somebody who was proposed cannot do it any more.
  [[nodiscard]] bool is_stale(const Alert& alert) const;

  /// Answers of robots to what they were asked.
  void receive(const Opaque& value, const std::string& robot, Now now, Outbox& out);
  void receive(const SensorReading& reading, const std::string& robot, Now now, Outbox& out);
  /// The robot refuses to be read. A Nack names no sensor: none of the robot's is waited for.
  void on_reading_refused(const std::string& robot);

 private:
  [[nodiscard]] const Criteria& criteria() const { return situation_.settings().resilience.criteria; }
  void ask_robot(const RobotRecord& robot, Duration fresh, Inquiry& inquiry, Now now, Outbox& out) const;
  void on_value(Now now, Outbox& out);
  [[nodiscard]] bool is_asked_for(const std::string& subtype) const;
  [[nodiscard]] bool is_able_to(const TaskForRobot& one, const WatchedRun* run) const;
  [[nodiscard]] bool is_out_of_bounds(const WatchedRun& run, std::size_t task, const RobotRecord& robot) const;

  Situation& situation_;
  Alerts& alerts_;
};

}  // namespace trb::resilience
