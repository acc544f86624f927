// Fault injection: orders a virtual robot to fail. A real robot never gets such an order.
#pragma once

#include <utility>

#include "common/actor/inbound.hpp"
#include "common/actor/outbox.hpp"
#include "services/mode-adapter/core/settings.hpp"

namespace trb::adapter {

class FaultInjection {
 public:
  /// `inject`: sends a line to the virtual robot; empty: the robot is real.
  FaultInjection(const Settings& settings, InjectLine inject) : settings_(settings), inject_(std::move(inject)) {}

  void on_inject(const Inbound& message, const InjectFault& order, Outbox& out) const;

 private:
  [[nodiscard]] Status injected(const InjectFault& order) const;

  const Settings& settings_;
  InjectLine inject_;
};

}  // namespace trb::adapter
