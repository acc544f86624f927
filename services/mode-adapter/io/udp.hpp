// Non-blocking UDP to one peer: each call is one datagram.
#pragma once

#include "services/mode-adapter/io/tcp.hpp"

namespace trb::adapter {

/// A socket that hears and reaches that peer alone; nobody is asked whether the peer is there. Errors: bad_value (no
/// IPv4 address), io_error.
Result<Descriptor> udp_dial(const std::string& address, std::uint16_t port);

/// The next datagram, which may be empty, if one has come. Errors: io_error; a host with nobody on that port says so
/// (connection refused).
struct Datagram {
  bool came = false;
  std::size_t bytes = 0;
};
Result<Datagram> udp_read(int fd, char* buffer, std::size_t size);

/// One datagram, whole or not at all: one that does not fit at the moment is lost, as on the way. Errors as udp_read's.
Status udp_write(int fd, BytesView bytes);

}  // namespace trb::adapter
