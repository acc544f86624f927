#pragma once

#include <optional>
#include <string>

#include "services/virtual-robots/mir/rest.hpp"
#include "services/virtual-robots/mir/robot.hpp"
#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/http_server.hpp"
#include "services/virtual-robots/support/robot_clock.hpp"

namespace trb::virtual_robots::mir {

struct Settings {
  Endpoint where{"127.0.2.2", 80};
  double speed = 1.0;
  std::optional<Endpoint> control;
  std::string user = "distributor";
  std::string password = "distributor";
  RobotSettings robot;
};

/** The robot, its REST interface by HTTP/1.1 and the clock in one loop. */
class VirtualMir {
 public:
  explicit VirtualMir(const Settings& settings);

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  HttpReply answer(const HttpRequest& request);
  void take_line(const std::string& line);

  RobotClock clock_;
  Robot robot_;
  Rest rest_;
  HttpServer server_;
  Console console_;
};

}  // namespace trb::virtual_robots::mir
