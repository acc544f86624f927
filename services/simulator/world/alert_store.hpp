// What a resilience service's database holds: of each alert the newest version, and a decision until it is delivered.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/resilience/core/resilience_core.hpp"

namespace trb::world {

class AlertStore {
 public:
  void write(const std::vector<Journal>& records);
  /// Hands a new process what is stored.
  void restore(resilience::ResilienceCore& core) const;
  [[nodiscard]] const std::map<std::string, Alert>& alerts() const { return alerts_; }
  /// By alert.
  [[nodiscard]] const std::map<std::string, resilience::StoredDecision>& decisions() const { return decisions_; }

 private:
  void end(const resilience::DecisionOver& is);
  void forget_oldest();

  std::map<std::string, Alert> alerts_;
  std::map<std::string, resilience::StoredDecision> decisions_;
};

}  // namespace trb::world
