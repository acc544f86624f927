#pragma once

#include <poll.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/process.hpp"

namespace trb::virtual_robots {

/**
 * What every virtual robot's loop waits for besides its own ports: its end, lines on stdin and on the control port, and
 * stdout becoming writable.
 */
class Console {
 public:
  /** `control`: the port for lines as datagrams. Throws std::system_error. */
  explicit Console(const std::optional<Endpoint>& control) : control_(control) {}

  /** Prints `ready WORDS`, and the control port if there is one. */
  void announce(std::string_view words) const;

  /** The first poll entries; the robot adds its own ports behind them. */
  std::vector<pollfd> to_poll(const Fd& end) const;
  /** Waits for one of them until `deadline`, in seconds of the steady clock. False: the program must end. */
  static bool wait(std::vector<pollfd>& polled, double deadline);
  /** The lines that poll has found. */
  std::vector<std::string> read(const std::vector<pollfd>& polled);

 private:
  StdinLines stdin_;
  ControlPort control_;
};

}  // namespace trb::virtual_robots
