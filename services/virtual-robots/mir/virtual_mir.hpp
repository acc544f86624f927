#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "services/virtual-robots/mir/rest.hpp"
#include "services/virtual-robots/mir/robot.hpp"
#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/robot_clock.hpp"
#include "services/virtual-robots/support/tcp_server.hpp"

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
  ~VirtualMir();

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  struct Intake;
  void take(TcpServer::Client& client);
  void take_line(const std::string& line);

  RobotClock clock_;
  Robot robot_;
  Rest rest_;
  TcpServer server_;
  std::map<std::uint64_t, std::unique_ptr<Intake>> intakes_;  ///< by client
  Console console_;
};

}  // namespace trb::virtual_robots::mir
