#pragma once

#include <sys/socket.h>

#include <optional>
#include <string>

namespace trb::op {

/// An address in the kernel's form.
struct SocketAddress {
  sockaddr_storage address{};
  socklen_t size = 0;

  [[nodiscard]] const sockaddr* data() const { return reinterpret_cast<const sockaddr*>(&address); }
  [[nodiscard]] int family() const { return address.ss_family; }
};

/// Of "10.0.0.1:45000" or "[fd00::1]:45000", with another port if one is given. Empty if it is neither: names are not
/// looked up.
std::optional<SocketAddress> socket_address(const std::string& address, std::optional<std::uint16_t> port = {});

/// Is the address in a network of one of this machine's interfaces?
bool in_own_subnet(const std::string& address);

}  // namespace trb::op
