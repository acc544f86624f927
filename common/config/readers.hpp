// The readers of a node's files; only for node_config.cpp and its neighbours.
#pragma once

#include <map>
#include <string>

#include "common/config/node_config.hpp"
#include "common/config/transports.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb {

using Profile = std::map<std::string, Mode>;                ///< framework -> mode
using AllCommands = std::map<std::string, VendorCommands>;  ///< framework -> its part of commands.json

/// network.json; interfaces are not checked.
Network read_network(const Value& json, const FileFaults& faults);

/// Fills address, broadcast and robot_address from the interfaces of this machine.
void resolve_network(NodeConfig& config, ConfigFaults& faults);

/// profile.json. An entry with an unknown mode is reported and has Mode::none.
Profile read_profile(const Value& json, const FileFaults& faults);

/// commands.json: the shape of every vendor's part.
AllCommands read_commands(const Value& json, const Transports& known, const FileFaults& faults);

/// "bus" of node.json: absent or "ipc", or "tcp://ADDRESS:PORT". Returns "" or ADDRESS:PORT.
std::string read_bus_key(ObjectReader& reader);

/// The content of node.json; paths of own services are relative to `config.dir`.
struct NodeFile {
  std::string description;  ///< path, relative to the node's folder or absolute
  bool usable = false;      ///< the id could be read
};
NodeFile read_node(const Value& json, NodeConfig& config, const FileFaults& faults);

}  // namespace trb
