// The configuration of the router's shell.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/config/metrics_file.hpp"
#include "common/security/beacon_key.hpp"
#include "common/transport/socket.hpp"
#include "services/router/core/pending_connections.hpp"

namespace trb::router {

/// A bus over TCP; without an address the bus is sockets in the node's folder.
struct TcpBus {
  std::string endpoint;  ///< for messages, in libzmq's notation
  std::string tap;
  CurveKeys keys;
  std::map<Bytes, std::string, std::less<>> names;  ///< public key -> the service that it proves, or "probe"
};

struct ShellOptions {
  CurveKeys link_keys;
  std::string host_int;  ///< an interface or an address: the inbox and the beacons
  std::string vpn_int;   ///< a second interface of the inbox, while it exists; may be empty
  std::uint16_t port = 0;
  std::uint16_t lane_port = 0;  ///< 0: any
  std::uint16_t beacon_port = 0;
  BeaconKey beacon_key;
  PendingConnectionLimits pending_connections;
  std::uint64_t proof_log_bytes = 0;  ///< the bound of log/proof; 0: no proof log
  TcpBus bus;
  std::optional<MetricsAddress> metrics;  ///< nothing: Prometheus is not answered
};

}  // namespace trb::router
