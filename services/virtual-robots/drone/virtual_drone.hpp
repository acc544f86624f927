#pragma once

#include <netinet/in.h>
#include <poll.h>

#include <optional>
#include <string>
#include <vector>

#include "services/virtual-robots/drone/controller.hpp"
#include "services/virtual-robots/support/console.hpp"

namespace trb::virtual_robots::drone {

struct Settings {
  std::string address = "127.0.2.6";
  std::optional<std::uint16_t> port = 5556;  ///< for commands; navdata has this port minus 2; none: free ones
  double speed = 1;
  double battery = 100;
  std::optional<Endpoint> control;
};

/** The drone, its two sockets and the clock in one loop. */
class VirtualDrone {
 public:
  explicit VirtualDrone(const Settings& settings);

  /** Runs until `end` becomes readable. */
  void run(const Fd& end);

 private:
  void read_commands();
  void read_wake_ups();
  void take_line(const std::string& line);
  void take_fault(const FaultOrder& order);
  void send_navdata();
  void tell_events();

  Fd commands_;
  Fd navdata_;
  Console console_;
  Controller controller_;
  std::optional<sockaddr_in> client_;  ///< receives navdata
  double next_navdata_ = 0;
};

}  // namespace trb::virtual_robots::drone
