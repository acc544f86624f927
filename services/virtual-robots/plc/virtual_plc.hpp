#pragma once

#include <optional>
#include <string>

#include "services/virtual-robots/plc/registers.hpp"
#include "services/virtual-robots/plc/server.hpp"
#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/robot_clock.hpp"

namespace trb::virtual_robots::plc {

struct Settings {
  Endpoint where{"127.0.2.2", 502};
  double speed = 1.0;
  std::optional<Endpoint> control;
  ConveyorSettings conveyor;
};

/** The conveyor, its Modbus server and the clock in one loop. */
class VirtualPlc {
 public:
  explicit VirtualPlc(const Settings& settings);

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  void take_line(const std::string& line);
  void tell_events();

  RobotClock clock_;
  Conveyor conveyor_;
  Registers registers_{conveyor_};
  Server server_;
  Console console_;
};

}  // namespace trb::virtual_robots::plc
