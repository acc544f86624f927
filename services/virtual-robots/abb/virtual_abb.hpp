#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/virtual-robots/abb/controller.hpp"
#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/robot_clock.hpp"
#include "services/virtual-robots/support/tcp_server.hpp"

namespace trb::virtual_robots::abb {

struct Settings {
  std::string address = "127.0.2.2";
  std::uint16_t port = 5000;
  std::uint16_t service_port = 5001;
  double speed = 1.0;
  std::optional<Endpoint> control;
  std::vector<Failure> failures;
};

/** The controller, the servers of its two tasks and the clock in one loop. */
class VirtualAbb {
 public:
  explicit VirtualAbb(const Settings& settings);

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  void serve_program(TcpServer::Client& client);
  void serve_service(TcpServer::Client& client);
  void answer(const std::optional<std::string>& text);
  void follow();
  void take_line(const std::string& line);
  void tell_events();

  RobotClock clock_;
  Controller controller_;
  TcpServer program_;
  TcpServer service_;
  std::uint64_t requester_ = 0;  ///< the client whose move is under way
  Console console_;
};

}  // namespace trb::virtual_robots::abb
