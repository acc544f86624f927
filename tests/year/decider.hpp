// The resilience core of the cloud's node, in a fleet in memory.
#pragma once

#include <map>
#include <memory>

#include "services/resilience/core/resilience_core.hpp"
#include "services/scheduler/test/fleet.hpp"

namespace trb::year {

class Decider final : public scheduler::test::Guest {
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

  void on(const Inbound& message, Now now, Outbox& out) override;
  void tick(Now now, Outbox& out) override;
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override;

  std::size_t most_alerts = 0;  ///< the most that its database held at a time

 private:
  void keep(const Outbox& out);
  void forget_old();
  Body ask(Body question);

  scheduler::test::Fleet& fleet_;
  ResilienceSettings settings_;
  std::unique_ptr<resilience::ResilienceCore> core_;
  std::map<std::string, Alert> alerts_;
  std::map<std::string, resilience::StoredDecision> decisions_;  ///< by alert
};

}  // namespace trb::year
