// What connections and datagrams to other machines show: for `trb doctor`.
#pragma once

#include <string>
#include <vector>

#include "common/operator/doctor/diagnosis.hpp"

namespace trb::cli {

struct HostPort {
  std::string host;  ///< IPv4, or IPv6 without its brackets
  std::string port;
};

/// Splits "10.0.0.1:45000" or "[fd00::1]:45000"; empty host if it is neither.
HostPort split_address(const std::string& address);

/// Tries all of them at once; takes at most about a second and a half. Says nothing on the connections and closes them.
void probe_ports(std::vector<op::AddressProbe>& probes);

/// The same for one address that need not be a router's: open is `zmtp` or `not_zmtp`.
op::Port probe_port(const std::string& address);

/// Sends datagrams that must not be fragmented to a port where nobody listens: the machine's answer (ICMP) tells
/// whether small and largest ones arrive. Takes at most about a second.
op::LargeDatagram probe_large_datagrams(const std::string& address);

/// Is the address in a network of one of this machine's interfaces?
bool in_own_subnet(const std::string& address);

}  // namespace trb::cli
