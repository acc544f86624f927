// Bodies between routers, and what a router knows about the fleet.
#pragma once

#include "proto/bodies/robot.hpp"
#include "proto/bodies/sensor.hpp"
#include "proto/bodies/signed.hpp"
#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

struct ParameterInfo {
  std::string name;
  std::string type;  ///< "number", "integer", "text", "bool", "place", "numbers"
  bool required = true;
  std::string unit;  ///< SI; empty for none
  /// Of a number: the lowest and the highest; an open end is the largest double. Empty: any.
  std::vector<double> range{};
  std::vector<std::string> one_of{};  ///< the values that a text or a place may have; empty: any
  std::uint32_t count = 0;            ///< of "numbers", how many; 0: any
  bool operator==(const ParameterInfo&) const = default;
  template <class T = ParameterInfo>
  static FieldTable fields() {
    return FieldTable{field("name", &T::name, 64), field("type", &T::type, 16),  field("required", &T::required),
                      field("unit", &T::unit, 16), field("range", &T::range, 2), field("one_of", &T::one_of, 64),
                      field("count", &T::count)};
  }
};

struct SkillInfo {
  std::string name;
  std::string capability;
  std::vector<ParameterInfo> parameters;
  bool repeatable = false;  ///< may be done again if it is unknown whether it was done
  double timeout_s = 0;
  bool operator==(const SkillInfo&) const = default;
  template <class T = SkillInfo>
  static FieldTable fields() {
    return FieldTable{field("name", &T::name, 64), field("capability", &T::capability, 64),
                      field("parameters", &T::parameters, 32), field("repeatable", &T::repeatable),
                      field("timeout_s", &T::timeout_s)};
  }
};

/// How the values that the robot sends relate to the hall's frame.
struct FrameInfo {
  double length = 0;  ///< the robot's units in a metre; 0: unknown
  double x = 0;       ///< where the robot's origin is in the hall, m
  double y = 0;
  double yaw = 0;  ///< and its rotation, rad
  bool operator==(const FrameInfo&) const = default;
  template <class T = FrameInfo>
  static FieldTable fields() {
    return FieldTable{field("length", &T::length), field("x", &T::x), field("y", &T::y), field("yaw", &T::yaw)};
  }
};

/// A number from the robot's description, such as its payload in kg.
struct NamedNumber {
  std::string name;
  double value = 0;
  std::string unit;
  bool operator==(const NamedNumber&) const = default;
  template <class T = NamedNumber>
  static FieldTable fields() {
    return FieldTable{field("name", &T::name, 64), field("value", &T::value), field("unit", &T::unit, 16)};
  }
};

/// Encoded. The largest robot of config/robots takes 0.4 kB, a plugged sensor 125 bytes; 255 of them, the maximum, take
/// half of this. The robot's node refuses more, and so does every peer: so every table of many profiles can be sent.
constexpr std::size_t kMaxProfileSize = 64U << 10U;

/// What a node publishes about its robot: mode-adapter -> router -> every peer, in Hello and again at each change.
struct NodeProfile {
  static constexpr std::string_view kSubtype = "node_profile";
  static constexpr Travel kTravel = between_routers(CostPhase::devices, {"mode-adapter"});
  std::string framework;
  std::string mode;
  std::string transport;
  std::string maker;
  std::string model;
  std::vector<std::string> capabilities;
  std::vector<std::string> sensors;
  std::vector<SkillInfo> skills;
  std::vector<std::string> places;  ///< the places that the robot can be sent to
  std::string robot;    ///< connection: "ONLINE", "OFFLINE", "CONNECTION_BROKEN", "" for a node without a robot
  std::string detail;   ///< why, when not ONLINE
  bool fenced = false;  ///< stopped until `release`
  std::string control;  ///< who commands it: a node's id, or "run ID"; empty: the first that sends a command
  std::vector<SensorInfo> plugged;     ///< sensors of the node's PC; each adds its kind to `capabilities`
  FrameInfo frame{};                   ///< the frame of the robot's own `position`
  std::vector<OutOfUse> out_of_use{};  ///< current faults, and whether it is retired
  std::vector<NamedNumber> numbers{};  ///< from the description
  std::vector<DriveInfo> drives{};     ///< what of the robot can be driven by hand
  bool operator==(const NodeProfile&) const = default;
  template <class T = NodeProfile>
  static FieldTable fields() {
    return FieldTable{field("framework", &T::framework, 64),
                      field("mode", &T::mode, 16),
                      field("transport", &T::transport, 16),
                      field("maker", &T::maker, 64),
                      field("model", &T::model, 64),
                      field("capabilities", &T::capabilities, 64),
                      field("sensors", &T::sensors, 255),
                      field("skills", &T::skills, 128),
                      field("places", &T::places, 255),
                      field("robot", &T::robot, 32),
                      field("detail", &T::detail, 255),
                      field("fenced", &T::fenced),
                      field("control", &T::control, 64),
                      field("plugged", &T::plugged, 255),
                      field("frame", &T::frame),
                      field("out_of_use", &T::out_of_use, kMaxOutOfUse),
                      field("numbers", &T::numbers, 64),
                      field("drives", &T::drives, 4)};
  }
};

/// The first message in each direction of a link.
struct Hello {
  static constexpr std::string_view kSubtype = "hello";
  static constexpr Travel kTravel = between_routers(CostPhase::identification);
  SignedRecord certificate;
  std::uint64_t boot = 0;
  std::string address;  ///< where the sender's inbox can be dialled
  std::string version;
  std::int64_t utc = 0;
  bool clock_verified = true;
  NodeProfile profile;
  std::uint64_t revocations = 0;  ///< number of the newest revocation list that the sender holds
  std::string seal = "behind";    ///< "behind" the delivery, or "before_delivery"
  bool relay = false;             ///< carries messages between members that cannot reach each other
  std::string lane;               ///< where the sender's lossy lane can be dialled, HOST:PORT; empty: it has none
  template <class T = Hello>
  static FieldTable fields() {
    return FieldTable{field("certificate", &T::certificate),
                      field("boot", &T::boot),
                      field("address", &T::address, 80),
                      field("version", &T::version, 32),
                      field("utc", &T::utc),
                      field("clock_verified", &T::clock_verified),
                      field("profile", &T::profile),
                      field("revocations", &T::revocations),
                      field("seal", &T::seal, 16),
                      field("relay", &T::relay),
                      field("lane", &T::lane, 80)};
  }
};

/// The sender's seal over everything that it sent on this link since its last seal.
struct Seal {
  static constexpr std::string_view kSubtype = "seal";
  static constexpr Travel kTravel = between_routers(CostPhase::upkeep);
  SignedRecord range;  ///< a SealedRange
  template <class T = Seal>
  static FieldTable fields() {
    return FieldTable{field("range", &T::range)};
  }
};

/// News from the authority: the newest revocation list, renewed certificates. Any member may send it, for the authority
/// has signed it; a node that learns something new from it passes that on.
struct TrustUpdate {
  static constexpr std::string_view kSubtype = "fleet_news";
  static constexpr Travel kTravel = between_routers(CostPhase::upkeep, {kProbe});
  SignedRecord revocations;  ///< a RevocationList; an empty kind for none
  std::vector<SignedRecord> certificates;
  template <class T = TrustUpdate>
  static FieldTable fields() {
    return FieldTable{field("revocations", &T::revocations), field("certificates", &T::certificates, 256)};
  }
};

/// A relay lists the nodes that it reaches: all when a link comes up (in several messages if need be), then each
/// change. A hint: that they are there, where, and what they are, they report themselves (RelayAlive, NodeProfile).
struct ReachablePeerList {
  static constexpr std::string_view kSubtype = "neighbours";
  static constexpr Travel kTravel = between_routers(CostPhase::identification);
  std::vector<SignedRecord> reached;  ///< their certificates
  std::vector<std::string> gone;      ///< ids
  template <class T = ReachablePeerList>
  static FieldTable fields() {
    return FieldTable{field("reached", &T::reached, 64), field("gone", &T::gone, 1024)};
  }
};

/// What two nodes that only a relay connects send each other through it, four times in a lease: it proves that the
/// other node is there now, and which of its messages have arrived. Only ever inside a `relayed`.
struct RelayAlive {
  static constexpr std::string_view kSubtype = "relay_alive";
  static constexpr Travel kTravel = in_record(CostPhase::upkeep);
  std::uint64_t nonce = 0;       ///< new and random each time; the other side repeats it
  std::uint64_t echo = 0;        ///< the newest nonce of the other side's proven boot; 0: no boot is proven
  std::uint64_t echo_other = 0;  ///< the newest nonce of an unproven boot; 0: none was received
  std::uint64_t heard_boot = 0;  ///< the other side's proven boot; 0: none
  std::uint64_t heard = 0;       ///< the highest count taken from that boot
  std::uint64_t mask = 0;        ///< bit i: count heard - i was taken
  std::string address;           ///< where the sender's inbox can be dialled
  std::string version;
  bool clock_verified = true;
  template <class T = RelayAlive>
  static FieldTable fields() {
    return FieldTable{field("nonce", &T::nonce),
                      field("echo", &T::echo),
                      field("echo_other", &T::echo_other),
                      field("heard_boot", &T::heard_boot),
                      field("heard", &T::heard),
                      field("mask", &T::mask),
                      field("address", &T::address, 80),
                      field("version", &T::version, 32),
                      field("clock_verified", &T::clock_verified)};
  }
};

/// Sent by a relay that could not pass a message on, to the message's signer.
struct RelayRefused {
  static constexpr std::string_view kSubtype = "relay_refused";
  static constexpr Travel kTravel = between_routers(CostPhase::upkeep);
  std::string target;
  std::uint64_t count = 0;
  std::string reason;  ///< an errc_name()
  template <class T = RelayRefused>
  static FieldTable fields() {
    return FieldTable{field("target", &T::target, 64), field("count", &T::count), field("reason", &T::reason, 64)};
  }
};

/// A message sent through a relay.
struct Relayed {
  static constexpr std::string_view kSubtype = "relayed";
  static constexpr Travel kTravel = between_routers(CostPhase::upkeep);
  SignedRecord record;  ///< a RelayedFrame
  template <class T = Relayed>
  static FieldTable fields() {
    return FieldTable{field("record", &T::record)};
  }
};

/// Requests the errors on a router's links: for `trb doctor`.
struct LinkErrorTableRequest {
  static constexpr std::string_view kSubtype = "link_troubles";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  template <class = void>
  static FieldTable fields() {
    return FieldTable{};
  }
};

struct LinkErrorRow {
  std::string peer;     ///< id, if known
  std::string address;  ///< the dialled address; empty if the other side dialled
  std::string code;     ///< an errc_name() or the name of a link's end, such as "refused_key"
  std::string text;
  std::uint64_t count = 0;  ///< how often in a row
  double last_s = 0;        ///< seconds since the last one
  template <class T = LinkErrorRow>
  static FieldTable fields() {
    return FieldTable{field("peer", &T::peer, 64),  field("address", &T::address, 80), field("code", &T::code, 64),
                      field("text", &T::text, 512), field("count", &T::count),         field("last_s", &T::last_s)};
  }
};

/// Bounded: the newest of each (peer, address, code).
struct LinkErrorTable {
  static constexpr std::string_view kSubtype = "link_trouble_table";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string node;
  std::vector<LinkErrorRow> errors;
  template <class T = LinkErrorTable>
  static FieldTable fields() {
    return FieldTable{field("node", &T::node, 64), field("troubles", &T::errors, 256)};
  }
};

/// Answered by a router with the same data: does a message of this size pass both ways?
struct EchoRequest {
  static constexpr std::string_view kSubtype = "echo_request";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  Blob pad;
  template <class T = EchoRequest>
  static FieldTable fields() {
    return FieldTable{field("pad", &T::pad, 65536)};
  }
};

struct Echo {
  static constexpr std::string_view kSubtype = "echo";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  Blob pad;
  template <class T = Echo>
  static FieldTable fields() {
    return FieldTable{field("pad", &T::pad, 65536)};
  }
};

/// Four in a lease. `heard` is the last sequence received, so that a one-way cut ends the lease on both sides.
struct KeepAlive {
  static constexpr std::string_view kSubtype = "keep_alive";
  static constexpr Travel kTravel = between_routers(CostPhase::upkeep);
  std::uint64_t heard = 0;
  template <class T = KeepAlive>
  static FieldTable fields() {
    return FieldTable{field("heard", &T::heard)};
  }
};

/// The link is over; the reason is for the log.
struct Goodbye {
  static constexpr std::string_view kSubtype = "goodbye";
  static constexpr Travel kTravel = between_routers(CostPhase::upkeep);
  std::string reason;
  template <class T = Goodbye>
  static FieldTable fields() {
    return FieldTable{field("reason", &T::reason, 128)};
  }
};

/// A row of the routing table (section 3.2.1).
struct Route {
  std::string id;
  Role role{};
  std::string address;
  std::string state;  ///< "self", "ONLINE", "CONNECTION_BROKEN" (link down, lease running), "OFFLINE" (expired)
  double last_heard_s = 0;
  std::uint64_t boot = 0;
  std::uint64_t link = 0;
  std::string dialled_by;
  std::string version;
  std::string clock;  ///< "verified" or "unverified"
  SignedRecord certificate;
  NodeProfile profile;
  std::string via;  ///< the relay through which it is reached; empty for a direct link
  template <class T = Route>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64),
                      field("role", &T::role),
                      field("address", &T::address, 80),
                      field("state", &T::state, 32),
                      field("last_heard_s", &T::last_heard_s),
                      field("boot", &T::boot),
                      field("link", &T::link),
                      field("dialled_by", &T::dialled_by, 64),
                      field("version", &T::version, 32),
                      field("clock", &T::clock, 16),
                      field("certificate", &T::certificate),
                      field("profile", &T::profile),
                      field("via", &T::via, 64)};
  }
};

struct RouteTable {
  static constexpr std::string_view kSubtype = "route_table";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string node;
  std::vector<Route> routes;
  bool more = false;     ///< more rows follow the last of these: request the next page
  std::string after{};   ///< the `after` of this page's request
  bool gathers = false;  ///< this router has just started: the table may lack members that it has not heard again
  template <class T = RouteTable>
  static FieldTable fields() {
    return FieldTable{field("node", &T::node, 64), field("routes", &T::routes, 2000), field("more", &T::more),
                      field("after", &T::after, 64), field("gathers", &T::gathers)};
  }
};

}  // namespace trb
