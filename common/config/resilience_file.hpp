// NODE_DIR/resilience.json: what counts when another robot is looked for, and who decides.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/robot.hpp"
#include "proto/value.hpp"

namespace trb {

/// What a criterion looks at. `charge`, `distance`, `availability`: those of the paper's Figure 8. The others are the
/// operator's: a value that the robot tells, a number of its description, a sensor of its node's PC.
enum class CriterionSource : std::uint8_t { charge = 0, distance, availability, robot, description, sensor };

/// One criterion of a ranking. Its direction follows from `best` and `worst`: a higher best is a benefit.
struct ReplacementCriterion {
  std::string name;
  CriterionSource from{};
  double weight = 0;    ///< its share of all; 0: it is shown, and bounds
  std::string value{};  ///< the robot's value, the description's number, the sensor's name or kind
  std::string unit{};
  double best = 100;  ///< what is better than that counts no more
  double worst = 0;
  std::optional<double> at_least{};  ///< who has less is no candidate, nor of whom it is not known
  std::optional<double> at_most{};
  std::vector<std::string> capabilities{};  ///< counts for tasks whose skills need one of these; empty: for every one
  bool operator==(const ReplacementCriterion&) const = default;
};

constexpr std::size_t kMaxCriteria = 16;
constexpr std::size_t kMaxCriterionValue = 56;  ///< bytes of ReplacementCriterion::value

/// When nobody needs to be asked. A person's word that a robot stands is never given by it.
struct ReplacementPolicy {
  bool automatic = false;
  bool asks_who_begins = false;  ///< of a task that names no robot, too: nothing failed, so nobody is asked otherwise
  double min_score = 0;          ///< of the best proposal's merit: against the best that is possible
  double min_lead = 0;           ///< of the best one's score over the second's
  Severity max_severity = Severity::fatal;
  std::uint32_t max_moves = 2;  ///< of one task; then a person is asked
};

struct ResilienceSettings {
  /// battery, distance and availability, then the operator's own in their order; the weights sum to 1. As they are
  /// without a file: of distance to battery 2, of distance to availability 3, of battery to availability 2
  /// (config/rank/paper-figure-8.json).
  std::vector<ReplacementCriterion> criteria;
  ReplacementPolicy policy;
  Duration expires = std::chrono::seconds(600);  ///< how long a proposal holds
};

/// Without a file: what the struct and Figure 8 say.
ResilienceSettings default_resilience();

/// Each fault is told; what is wrong keeps its default.
ResilienceSettings read_resilience(const Value& json, const std::string& file, ConfigFaults& faults);

/// NODE_DIR/resilience.json; a node needs none.
ResilienceSettings read_resilience_file(const std::string& node_dir, ConfigFaults& faults);

}  // namespace trb
