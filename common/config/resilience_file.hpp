// NODE_DIR/resilience.json: what counts when another robot is looked for, and who decides.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/robot.hpp"
#include "proto/value.hpp"

namespace trb {

/// Shares of the three criteria of the paper's Figure 8; their sum is 1. As they are: of distance to battery 2, of
/// distance to availability 3, of battery to availability 2 (config/rank/paper-figure-8.json).
struct ReplacementWeights {
  double battery = 0;
  double distance = 0;
  double availability = 0;
  bool operator==(const ReplacementWeights&) const = default;
};

/// When nobody needs to be asked. A person's word that a robot stands is never given by it.
struct ReplacementPolicy {
  bool automatic = false;
  bool asks_who_begins = false;  ///< of a task that names no robot, too: nothing failed, so nobody is asked otherwise
  double min_score = 0;          ///< of the best proposal; all scores sum to 1
  double min_lead = 0;           ///< of the best one's score over the second's
  Severity max_severity = Severity::fatal;
  std::uint32_t max_moves = 2;  ///< of one task; then a person is asked
};

struct ResilienceSettings {
  ReplacementWeights weights;
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
