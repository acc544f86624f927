#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/virtual-robots/kuka/codec.hpp"
#include "services/virtual-robots/kuka/program.hpp"
#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/robot_clock.hpp"
#include "services/virtual-robots/support/tcp_server.hpp"

namespace trb::virtual_robots::kuka {

struct Settings {
  std::string address = "127.0.2.2";
  std::uint16_t port = 7000;
  double speed = 1.0;
  std::optional<Endpoint> control;
  std::vector<Failure> failures;
};

/** The controller, its C3 server and the clock in one loop. */
class VirtualKuka {
 public:
  explicit VirtualKuka(const Settings& settings);

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  void serve(TcpServer::Client& client);
  std::string answer(const Request& request);
  void take_line(const std::string& line);
  void tell_events();

  RobotClock clock_;
  Program program_;
  TcpServer server_;
  Console console_;
};

}  // namespace trb::virtual_robots::kuka
