// The network interfaces of this machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace trb {

/// Where beacons are sent on a network without IPv4: a transient link-local group ("rb" "ea"), so that, like a
/// broadcast, they stay on that cable.
constexpr const char* kBeaconGroup = "ff12::7262:6561";

/// One address of an interface. A link-local one includes its scope, "fe80::1%eth0".
struct Interface {
  std::string name;
  std::string address;
  std::string broadcast;  ///< IPv6: kBeaconGroup with the scope; empty if the interface has none, such as tun0
  bool up = false;
};

/// Sorted by name, the loopback last; within an interface IPv4 first, link-local addresses last.
std::vector<Interface> interfaces();

bool is_ipv4(const std::string& text);
/// Also true with a scope.
bool is_ipv6(const std::string& text);

/// HOST:PORT, an IPv6 address in square brackets.
std::string join_host_port(const std::string& host, std::uint16_t port);
struct Endpoint {
  std::string host;  ///< an address, without brackets; empty if the text has none
  std::uint16_t port = 0;
};
/// Of "10.0.0.1:46000" or "[fd00::1]:46000"; a name is not an address.
Endpoint split_endpoint(const std::string& address);
/// "fe80::1%eth0" without "%eth0": a scope has no meaning on another machine.
std::string without_scope(const std::string& address);
/// The same address as this machine must write it: a link-local one, in brackets or not, gets the scope `interface`.
std::string with_scope(const std::string& address, const std::string& interface);

/// Finds the interface of that name or address. Any 127.x.y.z is an address of the loopback, whose broadcast is assumed
/// to be 127.255.255.255, so that several nodes of one machine receive each other. `known` is the result of
/// interfaces().
struct Resolved {
  std::string address;
  std::string broadcast;
  std::string what;  ///< why not; empty if found
  std::string hint;
  std::string interface;  ///< its name; "lo" for 127.x.y.z
  bool may_come = false;  ///< not found, but an interface of that name may come, come up or get its address later
};
Resolved resolve_interface(const std::string& name_or_address, const std::vector<Interface>& known);

}  // namespace trb
