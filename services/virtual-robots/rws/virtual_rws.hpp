#pragma once

#include <optional>
#include <string>

#include "services/virtual-robots/rws/controller.hpp"
#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/http_server.hpp"
#include "services/virtual-robots/support/robot_clock.hpp"

namespace trb::virtual_robots::rws {

struct Settings {
  Endpoint where{"127.0.2.2", 80};
  double speed = 1.0;
  std::optional<Endpoint> control;
  AccessSettings access;
};

/** The controller, its web services by HTTP/1.1 and the clock in one loop. */
class VirtualRws {
 public:
  explicit VirtualRws(const Settings& settings);

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  void take_line(const std::string& line);

  RobotClock clock_;
  Controller controller_;
  HttpServer server_;
  Console console_;
};

}  // namespace trb::virtual_robots::rws
