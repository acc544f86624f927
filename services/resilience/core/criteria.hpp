// The criteria by which another robot is chosen: their values, bounds and worth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/resilience_file.hpp"
#include "proto/bodies/resilience.hpp"
#include "services/resilience/core/candidates.hpp"

namespace trb::resilience {

using Criteria = std::vector<ReplacementCriterion>;

/// kUnknown: not known. `told`: when the robot reported it; nothing: it does not come from the robot.
struct Measured {
  double value = kUnknown;
  std::optional<UtcTime> told;
};

/// `place`: where the first task begins.
[[nodiscard]] Measured measure(const ReplacementCriterion& criterion, const RobotRecord& robot,
                               const std::optional<HallPoint>& place);

/// Does it matter for these tasks: do they have a place, a skill that needs one of its capabilities?
[[nodiscard]] bool counts(const ReplacementCriterion& criterion, const std::vector<TaskNeed>& needs,
                          const RobotRecord& robot, const std::optional<HallPoint>& place);

/// Why this value excludes the robot, "battery 1 %, at least 20 wanted"; empty: it does not.
[[nodiscard]] std::string why_out(const ReplacementCriterion& criterion, double value);

/// The same for all criteria that matter.
[[nodiscard]] std::string why_out(const Criteria& criteria, const std::vector<TaskNeed>& needs,
                                  const RobotRecord& robot, const std::optional<HallPoint>& place);
/// The criteria with these weights, as shares of all; one that is left out counts nothing. No weights: unchanged.
/// Errors: bad_value.
Result<Criteria> weighed(Criteria criteria, const std::vector<WeighedCriterion>& weights);
[[nodiscard]] bool has_bounds(const Criteria& criteria);

/// From 0 (the worst, or not known) to 1 (the best possible).
[[nodiscard]] double worth(const ReplacementCriterion& criterion, double value);

/// The name under which a sensor's reading is kept among a robot's values.
[[nodiscard]] std::string sensor_value(std::string_view sensor);
/// Is it the sensor of that criterion: by its name at the robot's node, or by its kind if no sensor there has the name?
[[nodiscard]] bool is_sensor_of(const ReplacementCriterion& criterion, const RobotRecord& robot,
                                std::string_view sensor);

/// What a robot is requested to send before it is proposed: subtypes of its requests, and sensors of its node.
struct Question {
  std::string value;    ///< its name among the robot's values
  std::string subtype;  ///< of the request; empty: a sensor's reading
  std::string sensor;
};
/// The values that are not known, or older than `fresh`.
[[nodiscard]] std::vector<Question> questions(const Criteria& criteria, const RobotRecord& robot, UtcTime now,
                                              Duration fresh);

}  // namespace trb::resilience
