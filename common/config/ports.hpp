// Is a port free? Tried by binding it; the socket is closed again at once.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/result.hpp"

namespace trb {

/// Errors: conflict (in use), not_permitted (below 1024 without the right), missing (the address is not on this
/// machine, or not yet), io_error. A port whose last connections are only in TIME_WAIT counts as free.
Status check_tcp_port(const std::string& address, std::uint16_t port);

}  // namespace trb
