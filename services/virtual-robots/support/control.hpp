#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/virtual-robots/support/options.hpp"
#include "services/virtual-robots/support/socket.hpp"

namespace trb::virtual_robots {

/**
 * The same lines as on stdin, as datagrams on a UDP port: one datagram is one line, with or without
 * a newline at its end. There is no answer: as with stdin, stdout shows the outcome.
 */
class ControlPort {
 public:
  static constexpr std::size_t kLongestLine = 4096;

  /** Without an endpoint there is no port. Throws std::system_error. */
  explicit ControlPort(const std::optional<Endpoint>& where);

  /** For a poll entry; -1, which poll skips, without a port. */
  int fd() const { return socket_.get(); }

  /** Prints `control PORT`, if there is one. */
  void announce() const;

  /** The lines that have come, at most 16 a call. A datagram too long, or of several lines, counts as an empty one. */
  std::vector<std::string> read();

 private:
  Fd socket_;
};

/** `--control HOST:PORT`, port `auto` or 0 for a free one. */
Option control_option(std::optional<Endpoint>& where);

/** The order `fault CAPABILITY [SEVERITY [TEXT...]]`. */
struct FaultOrder {
  std::string capability;
  std::string severity = "CRITICAL";  ///< WARNING, URGENT, CRITICAL or FATAL
  std::string text;
};

/** From the words after `fault`; nothing without a capability, or with another severity. */
std::optional<FaultOrder> parse_fault_order(std::string_view words);

}  // namespace trb::virtual_robots
