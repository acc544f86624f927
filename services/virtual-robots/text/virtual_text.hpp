#pragma once

#include <memory>
#include <optional>
#include <string>

#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/robot_clock.hpp"
#include "services/virtual-robots/support/tcp_server.hpp"
#include "services/virtual-robots/text/dialogue.hpp"

namespace trb::virtual_robots::text {

struct Settings {
  Endpoint where{"127.0.2.2", 29999};
  double speed = 1.0;
  std::optional<Endpoint> control;
  std::string profile = "dobot";
  std::string password = "secret";
};

/** The robot of that profile, its port and the clock in one loop. */
class VirtualText {
 public:
  explicit VirtualText(const Settings& settings);

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  static constexpr std::size_t kLongestRequest = 65536;

  void take(TcpServer::Client& client);
  void take_order(const std::string& line);
  void say(const std::string& line);

  RobotClock clock_;
  std::unique_ptr<Dialogue> robot_;
  TcpServer server_;
  std::uint64_t client_ = 0;  ///< who has asked last
  bool mute_ = false;         ///< it answers nothing
  Console console_;
};

}  // namespace trb::virtual_robots::text
