// Where a node's bus is: sockets in its folder, or TCP with a key for each service (node.json's "bus").
#pragma once

#include <optional>
#include <string>

#include "common/transport/socket.hpp"

namespace trb {

struct BusAddress {
  std::string endpoint;              ///< for libzmq
  std::optional<CurveClient> curve;  ///< over TCP
  [[nodiscard]] const CurveClient* keys() const { return curve ? &*curve : nullptr; }
};

/// The socket bus/NAME.ipc of the working directory.
BusAddress ipc_bus(const std::string& name);

/// For a service of this name, or "probe", of the node whose folder is the working directory. Errors: as for read_bus,
/// load_bus_key and load_bus_public.
Result<BusAddress> bus_address(const std::string& name);
/// The tap of that node, for "probe".
Result<BusAddress> tap_address();

}  // namespace trb
