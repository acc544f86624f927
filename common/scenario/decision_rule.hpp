// Who decides on a run. All code asks this rule; if an election replaces it, only this file changes.
#pragma once

#include <string>
#include <vector>

#include "proto/bodies/run.hpp"

namespace trb {

/// Whether a member's certificate names the cloud role. To rely on it, open the certificate with the authority's key.
bool says_cloud(const Member& member);

/// The first cloud node among the members, according to their certificates; empty: there is none.
std::string first_cloud_of(const std::vector<Member>& members);

/// The rule of one run, made from its start.
class DecisionRule {
 public:
  DecisionRule() = default;
  explicit DecisionRule(const RunStart& start);

  /// The only node that may make the run's next epoch: the first cloud node of the start; empty: no node may.
  [[nodiscard]] const std::string& decider() const { return decider_; }
  [[nodiscard]] bool may_decide(const std::string& node) const { return !decider_.empty() && node == decider_; }
  /// Who has every result in the end and states that the run has FINISHED: the decider, or without one the submitter.
  [[nodiscard]] const std::string& judge() const { return judge_; }

 private:
  std::string decider_;
  std::string judge_;
};

}  // namespace trb
