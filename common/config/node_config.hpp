// A node's folder: node.json, Appendix A's three files, the description and the places, read and checked as one.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/fleet/description.hpp"

namespace trb {

enum class Mode : std::uint8_t { none = 0, interpreter, direct, ros };
constexpr auto enum_names(Mode) {
  return std::array<std::string_view, 4>{"none", "interpreter", "direct", "ros"};
}

/// A peer that is dialled before any beacon of it: address and link key (hexadecimal, from `trb fleet show`).
struct Seed {
  std::string address;  ///< HOST:PORT
  std::string key;      ///< 32 raw bytes
};

struct RobotLink {
  std::string host;             ///< the robot's address: dialled in direct mode, the only one accepted on TCP_PORT
  std::string ros_namespace;    ///< where its relative topic names are; empty: "/"
  std::string interface;        ///< an interface or a local address: where TCP_PORT is bound
  std::optional<Pose> origin;   ///< in the hall; takes precedence over the description's, which robots of one type
                                ///< share
  std::string fault_injection;  ///< HOST:PORT, the control port of a virtual robot; empty: a real one
};

/// network.json, Appendix A's Figure A2.
struct Network {
  std::uint16_t udp_port = 50000;      ///< beacons
  std::uint16_t tcp_port_ext = 45000;  ///< other routers
  std::uint16_t lane_port = 45001;     ///< other routers, the lossy lane: TCP_PORT_EXT + 1 by default; 0: any
  std::uint16_t tcp_port = 40000;      ///< the node's robot
  std::string host_int;                ///< an interface or an address
  std::string vpn_int;
  // resolved from the interfaces of this machine by check_node_dir:
  std::string address;    ///< of host_int; empty: see waits_for
  std::string broadcast;  ///< of host_int's network
  std::string waits_for;  ///< why `address` is empty, if that may change by itself: an interface that does not exist
                          ///< yet
  std::string robot_address;  ///< of robot.interface, or `address`
};

/// What a vendor's monitor connection reports (state, completion, errors).
struct Monitor {
  std::string protocol;  ///< "ur-primary", "ar-navdata" …: see common/drivers
  std::uint16_t port = 0;
};

/// One vendor's part of commands.json, Appendix A's Figure A3.
struct VendorCommands {
  std::optional<std::uint16_t> port;
  std::string transport;           ///< "tcp-text", "modbus", "ros" …: see common/drivers
  std::string language = "plain";  ///< how text and lists are written: "plain" or "urscript"
  std::string wrap;                ///< "urscript-program": commands become a named program, so that its end is reported
  std::map<std::string, std::string> commands;  ///< subtype -> the vendor's text with {data} or {0}, {1} …
  std::map<std::string, std::string> values;    ///< name -> where the robot reports it, in the transport's notation
  std::map<std::string, std::string> requests;  ///< subtype -> a name that the monitor reports, for example "joints"
  std::optional<Monitor> monitor;
  std::optional<std::uint16_t> data_port;                 ///< of a connection for measured data, beside the monitor's
  std::map<std::string, double> numbers;                  ///< further keys of the transport's own, as far as given
  std::map<std::string, std::vector<std::string>> texts;  ///< the same of its texts and lists of texts
};

class Transports;

struct NodeConfig {
  std::string dir;  ///< absolute
  std::string id;
  Role role{};
  std::string framework;  ///< empty for a node without a robot
  Mode mode{};
  std::vector<std::string> services;  ///< the middleware's, then the operator's own
  /// "own_services": name -> absolute path of its program, which is started as `PROGRAM NODE_DIR`.
  std::map<std::string, std::string> own_services;
  RobotLink robot;
  std::vector<Seed> seeds;
  std::string bus;  ///< HOST:PORT of a bus over TCP, its tap one port further; empty: sockets in NODE_DIR/bus
  std::string dbus = "system";  ///< where sensors' values are published: "system", "session" or "unix:path=…"
  bool beacon = true;
  bool relay = false;                 ///< carries messages between members that cannot reach each other
  bool seal_before_delivery = false;  ///< deliver messages from other nodes only once their seal was checked
  std::uint32_t proof_log_mb = 64;    ///< how much of messages and seals is kept for trb proof; 0: none
  std::uint32_t archive_mb = 256;     ///< how much is kept of runs that are over
  Network network;
  Description description;
  Places places;
  VendorCommands commands;  ///< of `framework`; empty for the interpreter mode without an entry

  [[nodiscard]] bool has_service(std::string_view name) const;
};

/// The address of that node's bus, as NodeConfig::bus; reads nothing else of node.json. Errors: missing, malformed,
/// bad_value.
Result<std::string> read_bus(const std::string& node_dir);

/// The names that have a key of a bus over TCP: the services ("router" binds the bus), and "probe" for trb.
std::vector<std::string> bus_names(const NodeConfig& config);

/// Reads and checks a node's folder. Every fault of every file is returned at once; nothing is started, no port stays
/// bound. Also checks what the files refer to: keys present with mode 0600, certificate valid for the id, interfaces
/// that exist, ports (the page's among them) that are free and own services' programs (both skipped with `running`), a
/// mode that this build has.
struct NodeCheck {
  NodeConfig config;
  ConfigFaults faults;
};
/// Without transports commands.json is not checked: its texts concern only a service that talks to the robot.
NodeCheck check_node_dir(const std::string& dir, bool running);
NodeCheck check_node_dir(const std::string& dir, bool running, const Transports& known);

}  // namespace trb
