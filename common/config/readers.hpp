// The readers of a node's files; only for node_config.cpp and its neighbours.
#pragma once

#include <map>
#include <string>

#include "common/config/node_config.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {

using Profile = std::map<std::string, Mode>;                ///< framework -> mode
using AllCommands = std::map<std::string, VendorCommands>;  ///< framework -> its part of commands.json

/// network.json; interfaces are not looked at.
Network read_network(const Value& json, const FileFaults& faults);

/// Fills address, broadcast and robot_address from the interfaces of this machine.
void resolve_network(NodeConfig& config, ConfigFaults& faults);

/// profile.json. An entry with an unknown mode is reported and has Mode::none.
Profile read_profile(const Value& json, const FileFaults& faults);

/// commands.json: the shape of every vendor's part.
AllCommands read_commands(const Value& json, const FileFaults& faults);

/// The transports that commands.json may name.
std::vector<std::string> transport_names();

/// What a vendor without "transport" means in that mode.
std::string default_transport(Mode mode);

/// That the node's own vendor has what its transport needs, and that the transport is of the node's mode.
void check_transport(const NodeConfig& config, const FileFaults& faults);

// One for each transport: the words of the node's own vendor can be read, its skills have words and ends that are seen.
void check_tcp_text(const NodeConfig& config, const FileFaults& faults);
void check_ros(const NodeConfig& config, const FileFaults& faults);
void check_arcos(const NodeConfig& config, const FileFaults& faults);
void check_udp_at(const NodeConfig& config, const FileFaults& faults);
void check_c3(const NodeConfig& config, const FileFaults& faults);
void check_modbus(const NodeConfig& config, const FileFaults& faults);

/// The keys that commands.json has for the transport modbus alone.
ModbusSettings read_modbus_settings(ObjectReader& vendor);
void check_rapid(const NodeConfig& config, const FileFaults& faults);

// Parts that several of them need.
/// "stop" is there, and no command but "release" is empty.
void check_words(const VendorCommands& vendor, const std::string& name, const FileFaults& faults);
void require_port(const NodeConfig& config, const FileFaults& faults, const std::string& example);

/// What the description watches (faults, sensors) is told by the robot; `file`: the description's.
void check_value_names(const NodeConfig& config, const std::string& file, ConfigFaults& faults);

/// "bus" of node.json: nothing or "ipc", or "tcp://ADDRESS:PORT". Empty, or ADDRESS:PORT.
std::string read_bus_key(ObjectReader& reader);

/// What node.json says; paths of own services are relative to `config.dir`.
struct NodeFile {
  std::string description;  ///< path, relative to the node's folder or absolute
  bool usable = false;      ///< the id could be read
};
NodeFile read_node(const Value& json, NodeConfig& config, const FileFaults& faults);

}  // namespace trb
