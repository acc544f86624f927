// Numeric addresses.
#pragma once

#include <string_view>

namespace trb {

/// HOST:PORT with an IPv4 address, or an IPv6 one in square brackets, which may have a scope ("[fe80::1%eth0]:45000"),
/// and a port from 1 to 65535: it needs no name lookup. A host name is not one.
bool is_numeric_endpoint(std::string_view text);

}  // namespace trb
