// Addresses that are numbers.
#pragma once

#include <string_view>

namespace trb {

/// HOST:PORT with an IPv4 address, or an IPv6 one in square brackets, which may bear a scope ("[fe80::1%eth0]:45000"),
/// and a port from 1 to 65535: nobody has to be asked where that is. A host's name is none.
bool is_numeric_endpoint(std::string_view text);

}  // namespace trb
