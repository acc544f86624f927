#include "common/config/interfaces.hpp"
#include "common/config/readers.hpp"

namespace trb {
namespace {

constexpr std::int64_t kLastPort = 65535;

std::uint16_t read_port(ObjectReader& reader, std::string_view key, std::uint16_t otherwise, std::int64_t least = 1) {
  return static_cast<std::uint16_t>(reader.integer(key, Need::optional, least, kLastPort).value_or(otherwise));
}

Resolved resolve(const std::string& name, const FileFaults& faults, const std::string& key,
                 const std::vector<Interface>& known) {
  Resolved out = resolve_interface(name, known);
  if (!out.what.empty()) faults.add(key, out.what, out.hint);
  return out;
}

}  // namespace

Network read_network(const Value& json, const FileFaults& faults) {
  ObjectReader reader(json, "", faults);
  Network network;
  network.udp_port = read_port(reader, "UDP_PORT", network.udp_port);
  network.tcp_port_ext = read_port(reader, "TCP_PORT_EXT", network.tcp_port_ext);
  const bool last = network.tcp_port_ext == kLastPort;
  network.lane_port =
      read_port(reader, "LANE_PORT", static_cast<std::uint16_t>(last ? 0 : network.tcp_port_ext + 1), 0);
  network.tcp_port = read_port(reader, "TCP_PORT", network.tcp_port);
  network.host_int = reader.text("HOST_INT", Need::required, 64).value_or("");
  network.vpn_int = reader.text("VPN_INT", Need::optional, 64).value_or("");
  reader.refuse_unknown_keys();
  if (network.tcp_port == network.tcp_port_ext) {
    faults.add("TCP_PORT", "is the same as TCP_PORT_EXT: the robot and the other routers cannot share a port",
               "use two different ports, for example 40000 and 45000");
  }
  if (network.lane_port != 0 && (network.lane_port == network.tcp_port || network.lane_port == network.tcp_port_ext)) {
    faults.add("LANE_PORT", "is the same as another port of this node; without it, it is TCP_PORT_EXT + 1",
               "use a port of its own, or 0 for any");
  }
  return network;
}

namespace {

void resolve_host(NodeConfig& config, const std::vector<Interface>& known, ConfigFaults& faults) {
  Network& network = config.network;
  if (network.host_int.empty()) return;
  const FileFaults file("network.json", faults);
  const Resolved host = resolve(network.host_int, file, "HOST_INT", known);
  if (host.may_come) {
    // An interface may come late (VPN, USB) or get its address late (DHCP); a wrong address stays wrong.
    faults.back().may_wait = true;
    network.waits_for = "HOST_INT: " + host.what;
  }
  network.address = host.address;
  network.broadcast = host.broadcast;
  if (config.beacon && host.what.empty() && host.broadcast.empty()) {
    file.add("HOST_INT", "'" + network.host_int + "' has no broadcast, so no beacon can be received there",
             "set \"beacon\" to false in node.json and name the peers in \"seeds\", or use another interface");
  }
}

/// The node's own address, unless node.json names another interface towards the robot.
void resolve_robot(NodeConfig& config, const std::vector<Interface>& known, ConfigFaults& faults) {
  const FileFaults file("node.json", faults);
  Network& network = config.network;
  network.robot_address = network.address;
  if (!config.robot.interface.empty()) {
    network.robot_address = resolve(config.robot.interface, file, "robot.interface", known).address;
  } else if (!config.robot.host.empty() && is_ipv6(network.address)) {
    file.add("robot.interface", "is missing: robots speak IPv4, and HOST_INT is " + network.address,
             "name the interface or the IPv4 address on which the robot is reached");
  }
}

}  // namespace

void resolve_network(NodeConfig& config, ConfigFaults& faults) {
  const std::vector<Interface> known = interfaces();
  resolve_host(config, known, faults);
  resolve_robot(config, known, faults);
}

}  // namespace trb
