#pragma once

#include <poll.h>

#include <cstdint>
#include <optional>
#include <string>

#include "services/virtual-robots/pioneer/controller.hpp"
#include "services/virtual-robots/support/console.hpp"
#include "services/virtual-robots/support/socket.hpp"

namespace trb::virtual_robots::pioneer {

struct Settings {
  std::string address = "127.0.2.2";
  std::uint16_t port = 8101;  ///< 0: a free one
  double speed = 1.0;
  Start start;
  std::optional<Endpoint> control;
};

/** The microcontroller, its one client and the clock in one loop. */
class VirtualPioneer {
 public:
  explicit VirtualPioneer(const Settings& settings);

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  void accept_one();
  void read_client();
  void write(std::string_view bytes);
  void drop(const char* reason);
  void take_line(const std::string& line);
  void fault(std::string_view words);
  void pass_time();
  void send_sip();

  double speed_;
  double sip_period_;  ///< seconds of real time
  double last_ = wall_seconds();
  double next_sip_ = last_;
  Controller controller_;
  Fd listener_;
  Fd client_;
  std::string output_;
  Console console_;
};

}  // namespace trb::virtual_robots::pioneer
