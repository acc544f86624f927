#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/process.hpp"
#include "services/virtual-robots/ur/controller.hpp"
#include "services/virtual-robots/ur/dashboard.hpp"
#include "services/virtual-robots/ur/server.hpp"

namespace trb::virtual_robots::ur {

struct Settings {
  std::string address = "127.0.2.2";
  std::optional<std::uint16_t> port_base = 30000;
  double speed = 1.0;
  std::optional<Endpoint> control;
  RobotMode mode = RobotMode::Running;
};

/** The controller, its server and the clock in one loop. */
class VirtualUr {
 public:
  explicit VirtualUr(const Settings& settings);

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  void serve(const std::vector<pollfd>& polled);
  void take_console_line(const std::string& line);
  void take_fault(const FaultOrder& order);
  void send_state();
  void tell_events();
  double next_deadline() const;
  double robot_now() const { return (wall_seconds() - begin_) * speed_; }
  std::uint64_t time_us() const { return static_cast<std::uint64_t>(robot_now() * 1e6); }

  double speed_;
  double begin_ = wall_seconds();
  double next_state_ = begin_;
  Controller controller_;
  Server server_;
  Dashboard dashboard_;
  StdinLines console_;
  ControlPort control_;
};

}  // namespace trb::virtual_robots::ur
