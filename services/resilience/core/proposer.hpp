// Keeps an open alert's proposals up to date, and requests missing values from the robots.
#pragma once

#include <string>

#include "services/resilience/core/alert_lifecycle.hpp"

namespace trb::resilience {

class Proposer {
 public:
  Proposer(Situation& situation, AlertLifecycle& alerts) : situation_(situation), alerts_(alerts) {}

  /// Makes the alert's proposals anew. The run is_known().
  void propose(Alert& alert, const WatchedRun& run, Now now);
  /// Ranks the alert's candidates by other weights, and requests what is old; the alert stays as it is. Errors:
  /// conflict (nobody can take it over, or its run is not known yet), bad_value (weights).
  Result<AlertRanking> rank_by(const Alert& alert, const std::vector<WeighedCriterion>& weights, Now now, Outbox& out);
  /// Requests values that are unknown or old, from robots that are proposed or that only a bound excludes.
  void request_values(const Alert& alert, Now now, Outbox& out);
  /// Requests and proposes anew: once after the start, if a proposal is stale, and if no robot could do it.
  void refresh(Alert& alert, const WatchedRun& run, Now now, Outbox& out);
  /// Updates the proposals by the values that have come.
  void follow_answers(Alert& alert, Now now, Outbox& out);
  /// Can a proposed robot no longer do it?
  [[nodiscard]] bool is_stale(const Alert& alert) const;

  /// Answers of robots to these requests.
  void receive(const Opaque& value, const std::string& robot, Now now, Outbox& out);
  void receive(const SensorReading& reading, const std::string& robot, Now now, Outbox& out);
  /// The robot's node refuses a reading. `sensor`: as it was asked for; empty, as from an older node, or a router that
  /// did not deliver the request: none of the robot's sensors is awaited any more.
  void on_reading_refused(const std::string& robot, const std::string& sensor);

 private:
  [[nodiscard]] const Criteria& criteria() const { return situation_.settings().resilience.criteria; }
  /// The alert's candidates by these criteria; returns the robots that only a bound excludes.
  std::vector<std::string> fill(Alert& alert, const WatchedRun& run, const Criteria& by, Now now) const;
  std::vector<WeightFlip> flips_of(Alert alert, const WatchedRun& run, const Criteria& by, Now now) const;
  void request_values_of(const RobotRecord& robot, Duration fresh, Inquiry& inquiry, Now now, Outbox& out) const;
  void on_value(Now now, Outbox& out);
  [[nodiscard]] bool is_asked_for(const std::string& subtype) const;
  [[nodiscard]] bool is_able_to(const TaskForRobot& one, const WatchedRun* run) const;
  [[nodiscard]] bool is_out_of_bounds(const WatchedRun& run, std::size_t task, const RobotRecord& robot) const;

  Situation& situation_;
  AlertLifecycle& alerts_;
};

}  // namespace trb::resilience
