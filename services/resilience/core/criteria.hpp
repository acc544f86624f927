// What counts when another robot is looked for: measured, bounded, and what it is worth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/resilience_file.hpp"
#include "services/resilience/core/candidates.hpp"

namespace trb::resilience {

using Criteria = std::vector<ReplacementCriterion>;

/// kUnknown: nobody knows. `told`: when the robot said so; nothing: it is no saying of the robot's.
struct Measured {
  double value = kUnknown;
  std::optional<UtcTime> told;
};

/// `place`: where the first task begins.
[[nodiscard]] Measured measure(const ReplacementCriterion& criterion, const RobotRecord& robot,
                               const std::optional<HallPoint>& place);

/// It says something about these tasks: they have a place, a skill that needs one of its capabilities.
[[nodiscard]] bool counts(const ReplacementCriterion& criterion, const std::vector<TaskNeed>& needs,
                          const RobotRecord& robot, const std::optional<HallPoint>& place);

/// Why the robot is no candidate by it, "battery 1 %, at least 20 wanted"; empty: it is.
[[nodiscard]] std::string why_out(const ReplacementCriterion& criterion, double value);

/// Of all the criteria that count.
[[nodiscard]] std::string why_out(const Criteria& criteria, const std::vector<TaskNeed>& needs,
                                  const RobotRecord& robot, const std::optional<HallPoint>& place);
[[nodiscard]] bool has_bounds(const Criteria& criteria);

/// 0 (the worst, or not known) to 1 (the best that is possible).
[[nodiscard]] double worth(const ReplacementCriterion& criterion, double value);

/// The name under which a sensor's reading is kept among a robot's values.
[[nodiscard]] std::string sensor_value(std::string_view sensor);
/// The sensor of that criterion: by its name at the robot's node, or by its kind.
[[nodiscard]] bool is_sensor_of(const ReplacementCriterion& criterion, const RobotRecord& robot,
                                std::string_view sensor);

/// What is asked of a robot before it is proposed: subtypes of its requests, and sensors of its node.
struct Question {
  std::string value;    ///< as it is kept among the robot's values
  std::string subtype;  ///< of the request; empty: a sensor's reading
  std::string sensor;
};
/// What is not known, or older than `fresh`.
[[nodiscard]] std::vector<Question> questions(const Criteria& criteria, const RobotRecord& robot, UtcTime now,
                                              Duration fresh);

}  // namespace trb::resilience
