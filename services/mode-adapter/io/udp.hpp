// Non-blocking UDP to one peer: each call is one datagram.
#pragma once

#include "services/mode-adapter/io/tcp.hpp"

namespace trb::adapter {

/// A socket that sends to and receives from this peer only; it is not checked whether the peer is there. Errors:
/// bad_value (not an IPv4 address), io_error.
Result<Descriptor> udp_dial(const std::string& address, std::uint16_t port);

/// The next datagram, which may be empty, if one has come. Errors: io_error, also if no process listens on the peer's
/// port (connection refused).
struct Datagram {
  bool came = false;
  std::size_t bytes = 0;
};
Result<Datagram> udp_read(int fd, char* buffer, std::size_t size);

/// One datagram, completely or not at all: if it cannot be sent at once it is lost. Errors: as udp_read's.
Status udp_write(int fd, BytesView bytes);

}  // namespace trb::adapter
