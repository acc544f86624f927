// The network interfaces of this machine.
#pragma once

#include <string>
#include <vector>

namespace trb {

/// One IPv4 address of an interface.
struct Interface {
  std::string name;
  std::string address;
  std::string broadcast;  ///< empty if the interface has none, as tun0
  bool up = false;
};

/// Sorted by name, the loopback last.
std::vector<Interface> interfaces();

bool is_ipv4(const std::string& text);

/// Finds the interface of that name or address. Any 127.x.y.z is an address of the loopback, whose broadcast is taken
/// to be 127.255.255.255, so that several nodes of one machine hear each other. `known` is what interfaces() gave.
struct Resolved {
  std::string address;
  std::string broadcast;
  std::string what;  ///< why not; empty if found
  std::string cure;
};
Resolved resolve_interface(const std::string& name_or_address, const std::vector<Interface>& known);

}  // namespace trb
