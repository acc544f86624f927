#include "common/service/bus_address.hpp"

#include "common/config/interfaces.hpp"
#include "common/config/node_config.hpp"
#include "common/security/bus_keys.hpp"

namespace trb {
namespace {

Result<BusAddress> over_tcp(const std::string& bus, const std::string& name, int further) {
  auto own = load_bus_key(".", name);
  if (!own) return own.error();
  auto router = load_bus_public(".", kBusRouter);
  if (!router) return router.error();
  const Endpoint at = split_endpoint(bus);
  const auto port = static_cast<std::uint16_t>(at.port + further);
  return BusAddress{"tcp://" + join_host_port(at.host, port),
                    CurveClient{{std::move(own->public_key), std::move(own->secret_key)}, std::move(*router)}};
}

Result<BusAddress> address_of(const std::string& socket, const std::string& key, int further) {
  auto bus = read_bus(".");
  if (!bus) return bus.error();
  return bus->empty() ? Result<BusAddress>(ipc_bus(socket)) : over_tcp(*bus, key, further);
}

}  // namespace

BusAddress ipc_bus(const std::string& name) {
  return {"ipc://bus/" + name + ".ipc", std::nullopt};
}

Result<BusAddress> bus_address(const std::string& name) {
  return address_of(name, name, 0);
}

Result<BusAddress> tap_address() {
  return address_of("tap", std::string(kBusProbe), 1);
}

}  // namespace trb
