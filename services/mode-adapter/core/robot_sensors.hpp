// The robot's values that the fleet receives: RobotState.
#pragma once

#include "common/actor/outbox.hpp"
#include "services/mode-adapter/core/drivers.hpp"

namespace trb::adapter {

/// When a named value changes, all are sent, once a second at most; a list (joints, a pose) changes with every motion,
/// and is only sent with the next change of another value.
class RobotSensors {
 public:
  explicit RobotSensors(const std::vector<std::string>& names);

  void on_value(std::string_view name, const RobotValue& value);
  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  std::vector<RobotValueTold> values_;  ///< without a value: not received yet
  bool changed_ = false;
  MonotonicTime not_before_;
};

}  // namespace trb::adapter
