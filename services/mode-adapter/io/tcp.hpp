// Non-blocking TCP: the few calls that the robot's connections need.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/bytes.hpp"
#include "common/base/descriptor.hpp"
#include "common/base/result.hpp"

namespace trb::adapter {

/// Errors: bad_value (not an IPv4 address), io_error.
Result<Descriptor> tcp_listen(const std::string& address, std::uint16_t port);
/// The port that a listener got; for tests that bind port 0.
std::uint16_t local_port(int fd);
/// Begins to connect; the descriptor becomes writable once the connect has ended.
Result<Descriptor> tcp_dial(const std::string& address, std::uint16_t port);
/// The result of a connect.
Status tcp_connected(int fd);

struct Accepted {
  Descriptor fd;
  std::string peer;
};
/// Accepts a waiting connection; none: an empty descriptor.
Accepted tcp_accept(int listener);

/// True if the peer writes no more: its end lies behind what is not read yet.
bool tcp_has_ended(int fd);

/// No Nagle; and a vanished peer is noticed within some 5 s, whether or not anything is sent to it.
void watch_over(int fd);

/// What could be read or written at once. Errors: io_error, with the system's text.
struct Transfer {
  std::size_t bytes = 0;
  bool closed = false;  ///< by the peer
};
Result<Transfer> tcp_read(int fd, char* buffer, std::size_t size);
Result<Transfer> tcp_write(int fd, BytesView bytes);

}  // namespace trb::adapter
