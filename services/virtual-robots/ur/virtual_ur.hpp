#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/robot_clock.hpp"
#include "services/virtual-robots/ur/controller.hpp"
#include "services/virtual-robots/ur/dashboard.hpp"
#include "services/virtual-robots/ur/rtde_server.hpp"
#include "services/virtual-robots/ur/server.hpp"

namespace trb::virtual_robots::ur {

struct Settings {
  std::string address = "127.0.2.2";
  std::optional<std::uint16_t> port_base = 30000;
  double speed = 1.0;
  std::optional<Endpoint> control;
  RobotMode mode = RobotMode::running;
  std::string programs;  ///< the folder of what the dashboard loads; empty: none
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
  void take_input(std::string_view words);
  void take_fault(const FaultOrder& order);
  void send_state();
  void tell_events();
  double next_deadline() const;
  std::uint64_t time_us() const { return static_cast<std::uint64_t>(clock_.now() * 1e6); }

  RobotClock clock_;
  double next_state_ = clock_.begin();
  Controller controller_;
  Server server_;
  Dashboard dashboard_;
  RtdeServer rtde_;
  Console console_;
};

}  // namespace trb::virtual_robots::ur
