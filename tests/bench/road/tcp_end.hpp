// A robot's TCP connection: a message is a line, and may have field lines before it.
#pragma once

#include "tests/bench/road/ends.hpp"

namespace trb::bench {

/// HOST:PORT split; throws if it is not valid.
struct TcpAddress {
  std::string host;
  std::uint16_t port = 0;
};
TcpAddress tcp_address(const std::string& text);

/// A listener of one connection. Prints "listening".
int tcp_listen(const TcpAddress& at);
/// Waits for the one connection.
int tcp_accept(int listener);
/// Connects, from `from` if it is not empty; tries for 5 s.
int tcp_dial(const TcpAddress& to, const std::string& from);

/// Owns the connection. `head` is sent before each message.
std::unique_ptr<End> tcp_end(int fd, std::string head);

}  // namespace trb::bench
