// NODE_DIR/resilience.json: which criteria count when another robot is chosen, and who decides.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/robot.hpp"
#include "proto/value.hpp"

namespace trb {

/// What a criterion is computed from. `charge`, `distance`, `availability`: those of the paper's Figure 8. The others
/// are the operator's: a value that the robot reports, a number of its description, a sensor of its node's PC.
enum class CriterionSource : std::uint8_t { charge = 0, distance, availability, robot, description, sensor };

/// One criterion of a ranking. Its direction follows from `best` and `worst`: a higher best is a benefit.
struct ReplacementCriterion {
  std::string name;
  CriterionSource from{};
  double weight = 0;    ///< its share of all; 0: it is only shown, and its bound applies
  std::string value{};  ///< the robot's value, the description's number, the sensor's name or kind
  std::string unit{};
  double best = 100;  ///< a better value counts no more than this
  double worst = 0;
  std::optional<double> at_least{};  ///< a robot with less, or with an unknown value, is no candidate
  std::optional<double> at_most{};
  std::vector<std::string> capabilities{};  ///< applies to tasks whose skills need one of these; empty: to every task
  bool operator==(const ReplacementCriterion&) const = default;
};

constexpr std::size_t kMaxCriteria = 16;
constexpr std::size_t kMaxCriterionValue = 56;  ///< bytes of ReplacementCriterion::value

/// When the policy decides without a person. It never replaces a person's confirmation that a robot stands still.
struct ReplacementPolicy {
  bool automatic = false;
  bool asks_who_begins = false;  ///< ask a person also for a task that names no robot: nothing failed, so by default
                                 ///< nobody is asked
  double min_score = 0;          ///< of the best proposal's merit: compared with the best possible
  double min_lead = 0;           ///< of the best one's score over the second's
  Severity max_severity = Severity::fatal;
  std::uint32_t max_moves = 2;  ///< of one task; after that a person is asked
};

struct ResilienceSettings {
  /// battery, distance and availability, then the operator's own in their order; the weights sum to 1. Without a file:
  /// of distance to battery 2, of distance to availability 3, of battery to availability 2
  /// (config/rank/paper-figure-8.json).
  std::vector<ReplacementCriterion> criteria;
  ReplacementPolicy policy;
  Duration expires = std::chrono::seconds(600);  ///< how long a proposal is valid
};

/// Without a file: the struct's defaults and Figure 8.
ResilienceSettings default_resilience();

/// Each fault is reported; a faulty value keeps its default.
ResilienceSettings read_resilience(const Value& json, const std::string& file, ConfigFaults& faults);

/// NODE_DIR/resilience.json; the file is optional.
ResilienceSettings read_resilience_file(const std::string& node_dir, ConfigFaults& faults);

}  // namespace trb
