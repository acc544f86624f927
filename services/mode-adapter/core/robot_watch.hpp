// Watches the robot's values for the faults and sensors that the description derives from them.
#pragma once

#include "services/mode-adapter/core/robot_faults.hpp"
#include "services/mode-adapter/core/robot_sensors.hpp"

namespace trb::adapter {

class RobotWatch {
 public:
  RobotWatch(const Settings& settings, RobotFaults& faults)
      : settings_(settings), faults_(faults), sensors_(settings.description.sensors) {}

  /// The driver has new values.
  void on_values(const Driver& mode, Now now, Outbox& out);
  /// The robot has sent its node a value in fields.
  void on_field(const Said& said, Now now, Outbox& out);
  void tick(Now now, Outbox& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  const Settings& settings_;
  RobotFaults& faults_;
  RobotSensors sensors_;
};

}  // namespace trb::adapter
