// Faults by word: a virtual robot is told to fail. A real one never is.
#pragma once

#include <utility>

#include "common/actor/inbound.hpp"
#include "common/actor/outbox.hpp"
#include "services/mode-adapter/core/settings.hpp"

namespace trb::adapter {

class FaultInjection {
 public:
  /// `inject`: hands a line to the virtual robot; empty: there is none.
  FaultInjection(const Settings& settings, InjectLine inject) : settings_(settings), inject_(std::move(inject)) {}

  void on_inject(const Inbound& message, const InjectFault& order, Outbox& out) const;

 private:
  [[nodiscard]] Status injected(const InjectFault& order) const;

  const Settings& settings_;
  InjectLine inject_;
};

}  // namespace trb::adapter
