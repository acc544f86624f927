// What `trb doctor` concludes from its observations: pure, so that every cause has a test.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/base/disk_state.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/bus.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run_view.hpp"

namespace trb::op {

/// What a TCP connection to an address showed.
enum class Port : unsigned char {
  not_tried,
  zmtp,       ///< something that speaks ZMTP, as a router does
  not_zmtp,   ///< something else listens, or sends nothing
  refused,    ///< the machine is there, but nothing listens
  no_answer,  ///< no answer in time
  no_route,   ///< this machine has no route to it
};

/// What datagrams of the largest size that should pass showed.
enum class LargeDatagram : unsigned char {
  not_known,  ///< the other side does not answer datagrams at all
  passed,
  lost,  ///< small ones pass, large ones are lost
};

/// An address at which a node should be, and the result of trying it.
struct AddressProbe {
  std::string address;  ///< HOST:PORT
  bool seed = false;    ///< from node.json
  bool own_subnet = false;
  Port port = Port::not_tried;
  LargeDatagram large = LargeDatagram::not_known;
};

/// Echoes of a linked node's router.
struct EchoProbe {
  std::string peer;
  bool small = false;
  bool large = false;
};

struct RobotProbe {
  std::string address;  ///< HOST:PORT that the node dials; empty if the robot dials the node
  Port port = Port::not_tried;
};

struct Observed {
  std::string node;  ///< id, from node.json
  ConfigFaults faults;
  bool beacon = true;                ///< node.json
  std::size_t seeds = 0;             ///< node.json
  std::vector<std::string> named{};  ///< node.json's services; empty if it could not be read
  bool has_robot = false;            ///< node.json names a framework
  std::optional<Certificate> own;
  UtcTime now;
  std::optional<DiskState> disk;             ///< that the node's folder is on
  std::optional<bool> clock_set;             ///< by something that keeps it set, such as NTP
  std::vector<std::string> missing_sockets;  ///< files of the bus that should be there
  bool bus_key_refused = false;              ///< over TCP: the router does not know the key of trb
  bool answers = false;                      ///< the router answers a probe
  bool inbox_open = false;                   ///< its port for other routers accepts connections
  RouteTable routes;
  RunTable runs;                 ///< how many the scheduler has and accepts; open_max 0: no answer
  std::optional<Error> no_runs;  ///< why it does not say
  Counters scheduler;            ///< what it has counted since its start
  ServiceTable services;
  LinkErrorTable errors;
  std::vector<AddressProbe> addresses;
  std::vector<EchoProbe> echoes;
  RobotProbe robot;
  std::string asked;  ///< the one peer (id or HOST:PORT) that the person named; empty for all
};

enum class Weight : unsigned char { note, problem };

struct Finding {
  Weight weight = Weight::problem;
  std::string cause;    ///< an identifier for programs: "wrong_key", "port_closed" …
  std::string subject;  ///< node, address or file
  std::string what;
  std::string hint;
};

/// Of a service that waits for its files.
inline constexpr std::string_view kWaitsHint = "do what it says; it tries again every second, and goes on by itself";

/// Problems first; empty if all is well.
std::vector<Finding> diagnose(const Observed& seen);

}  // namespace trb::op
