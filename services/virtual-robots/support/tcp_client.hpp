#pragma once

#include <poll.h>

#include <string>
#include <string_view>

#include "services/virtual-robots/support/socket.hpp"

namespace trb::virtual_robots {

/** A client's connection and the bytes that wait for it. It never waits itself: the loop around it polls. */
struct TcpClient {
  Fd socket;
  std::string output;
  bool gone = false;  ///< its server removes it

  /** What poll is asked: for input, and while bytes wait, for room. */
  pollfd polled() const;
  /** Sends what the connection takes now. */
  void flush();
  /** Prints `client_dropped REASON`. */
  void drop(std::string_view reason);
};

}  // namespace trb::virtual_robots
