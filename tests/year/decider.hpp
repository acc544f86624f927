// The resilience core of the cloud's node, in a fleet in memory.
#pragma once

#include <memory>
#include <vector>

#include "services/resilience/core/resilience_core.hpp"
#include "services/scheduler/test/fleet.hpp"
#include "services/simulator/world/alert_store.hpp"

namespace trb::year {

class Decider {
 public:
  Decider(scheduler::test::Fleet& fleet, ResilienceSettings settings);

  /// The process starts (again), with the contents of its database.
  void start();
  /// Its own router reports another node.
  void tell(Body word);
  /// The alerts that are open.
  std::vector<Alert> alerts();
  /// A person's verdict on an alert; returns the answer.
  Body decide(const AlertDecide& verdict);

  std::size_t most_alerts = 0;  ///< the most that its database held at a time

 private:
  void store(const std::vector<Journal>& records);
  Body ask(Body question);

  scheduler::test::Fleet& fleet_;
  ResilienceSettings settings_;
  std::unique_ptr<resilience::ResilienceCore> core_;
  world::AlertStore store_;
};

}  // namespace trb::year
