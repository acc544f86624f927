// Bodies between routers, and what a router knows of the fleet.
#pragma once

#include "proto/bodies/sensor.hpp"
#include "proto/bodies/signed.hpp"
#include "proto/field.hpp"

namespace trb {

struct ParameterInfo {
  std::string name;
  std::string type;  ///< "number", "integer", "text", "bool", "place", "numbers"
  bool required = true;
  std::string unit;  ///< SI; empty for none
  /// Of a number, the lowest and the highest; an open end is the largest double. Empty: any.
  std::vector<double> range{};
  std::vector<std::string> one_of{};  ///< the words that a text or a place may be; empty: any
  std::uint32_t count = 0;            ///< of "numbers", how many; 0: any
  bool operator==(const ParameterInfo&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("name", &ParameterInfo::name, 64),     field("type", &ParameterInfo::type, 16),
                      field("required", &ParameterInfo::required), field("unit", &ParameterInfo::unit, 16),
                      field("range", &ParameterInfo::range, 2),    field("one_of", &ParameterInfo::one_of, 64),
                      field("count", &ParameterInfo::count)};
  }
};

struct SkillInfo {
  std::string name;
  std::string capability;
  std::vector<ParameterInfo> parameters;
  bool repeatable = false;  ///< may be done again if nobody knows whether it was done
  double timeout_s = 0;
  bool operator==(const SkillInfo&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("name", &SkillInfo::name, 64), field("capability", &SkillInfo::capability, 64),
                      field("parameters", &SkillInfo::parameters, 32), field("repeatable", &SkillInfo::repeatable),
                      field("timeout_s", &SkillInfo::timeout_s)};
  }
};

/// How the values that the robot tells relate to the hall's frame.
struct FrameInfo {
  double length = 0;  ///< the robot's units a metre; 0: not told
  double x = 0;       ///< where the robot's origin is in the hall, m
  double y = 0;
  double yaw = 0;  ///< and how it is turned, rad
  bool operator==(const FrameInfo&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("length", &FrameInfo::length), field("x", &FrameInfo::x), field("y", &FrameInfo::y),
                      field("yaw", &FrameInfo::yaw)};
  }
};

/// What a node tells of its robot: mode-adapter -> router -> every peer, in Hello and again at each change.
struct NodeProfile {
  static constexpr std::string_view kSubtype = "node_profile";
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
  std::string control;  ///< who commands it: a node's id, or "run ID"; empty: whoever comes first
  std::vector<SensorInfo> plugged;  ///< sensors of the node's PC; each adds its kind to `capabilities`
  FrameInfo frame{};                ///< of the robot's own `position`
  bool operator==(const NodeProfile&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("framework", &NodeProfile::framework, 64),
                      field("mode", &NodeProfile::mode, 16),
                      field("transport", &NodeProfile::transport, 16),
                      field("maker", &NodeProfile::maker, 64),
                      field("model", &NodeProfile::model, 64),
                      field("capabilities", &NodeProfile::capabilities, 64),
                      field("sensors", &NodeProfile::sensors, 255),
                      field("skills", &NodeProfile::skills, 128),
                      field("places", &NodeProfile::places, 255),
                      field("robot", &NodeProfile::robot, 32),
                      field("detail", &NodeProfile::detail, 255),
                      field("fenced", &NodeProfile::fenced),
                      field("control", &NodeProfile::control, 64),
                      field("plugged", &NodeProfile::plugged, 255),
                      field("frame", &NodeProfile::frame)};
  }
};

/// The first message each way on a link.
struct Hello {
  static constexpr std::string_view kSubtype = "hello";
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
  static constexpr auto fields() {
    return std::tuple{field("certificate", &Hello::certificate),
                      field("boot", &Hello::boot),
                      field("address", &Hello::address, 80),
                      field("version", &Hello::version, 32),
                      field("utc", &Hello::utc),
                      field("clock_verified", &Hello::clock_verified),
                      field("profile", &Hello::profile),
                      field("revocations", &Hello::revocations),
                      field("seal", &Hello::seal, 16),
                      field("relay", &Hello::relay),
                      field("lane", &Hello::lane, 80)};
  }
};

/// The sender's seal over what it sent on this link since its last one.
struct Seal {
  static constexpr std::string_view kSubtype = "seal";
  SignedRecord range;  ///< a SealedRange
  static constexpr auto fields() { return std::tuple{field("range", &Seal::range)}; }
};

/// What the authority has said since: the newest revocation list, renewed certificates. Any member may bring it, for
/// the authority has signed it; whoever learns something new from it hands that on.
struct FleetNews {
  static constexpr std::string_view kSubtype = "fleet_news";
  SignedRecord revocations;  ///< a RevocationList; an empty kind for none
  std::vector<SignedRecord> certificates;
  static constexpr auto fields() {
    return std::tuple{field("revocations", &FleetNews::revocations),
                      field("certificates", &FleetNews::certificates, 256)};
  }
};

/// A node that a relay is linked with.
struct Neighbour {
  SignedRecord certificate;
  std::uint64_t boot = 0;
  std::string address;
  std::string version;
  bool clock_verified = true;
  NodeProfile profile;
  static constexpr auto fields() {
    return std::tuple{field("certificate", &Neighbour::certificate),       field("boot", &Neighbour::boot),
                      field("address", &Neighbour::address, 80),           field("version", &Neighbour::version, 32),
                      field("clock_verified", &Neighbour::clock_verified), field("profile", &Neighbour::profile)};
  }
};

/// A node that a relay was linked with.
struct NeighbourGone {
  std::string id;
  std::uint64_t silent_ms = 0;  ///< since its last sign of life there: the others' lease runs from then
  static constexpr auto fields() {
    return std::tuple{field("id", &NeighbourGone::id, 64), field("silent_ms", &NeighbourGone::silent_ms)};
  }
};

/// A relay tells whom it reaches: all of them when a link comes up (in several messages if need be), then each change.
struct Neighbours {
  static constexpr std::string_view kSubtype = "neighbours";
  std::vector<Neighbour> reached;
  std::vector<NeighbourGone> gone;
  static constexpr auto fields() {
    return std::tuple{field("reached", &Neighbours::reached, 64), field("gone", &Neighbours::gone, 1024)};
  }
};

/// A message by way of a relay.
struct Relayed {
  static constexpr std::string_view kSubtype = "relayed";
  SignedRecord record;  ///< a RelayedFrame
  static constexpr auto fields() { return std::tuple{field("record", &Relayed::record)}; }
};

/// Asks a router what has gone wrong with its links: for `trb doctor`.
struct LinkTroublesRequest {
  static constexpr std::string_view kSubtype = "link_troubles";
  static constexpr auto fields() { return std::tuple{}; }
};

struct LinkTrouble {
  std::string peer;     ///< id, if known
  std::string address;  ///< dialled; empty if it came from outside
  std::string code;     ///< an errc_name() or the name of a link's end, as "refused_key"
  std::string text;
  std::uint64_t count = 0;  ///< how often, one after the other
  double last_s = 0;        ///< how long ago the last was
  static constexpr auto fields() {
    return std::tuple{field("peer", &LinkTrouble::peer, 64), field("address", &LinkTrouble::address, 80),
                      field("code", &LinkTrouble::code, 64), field("text", &LinkTrouble::text, 512),
                      field("count", &LinkTrouble::count),   field("last_s", &LinkTrouble::last_s)};
  }
};

/// Bounded: the newest of each (peer, address, code).
struct LinkTroubles {
  static constexpr std::string_view kSubtype = "link_trouble_table";
  std::string node;
  std::vector<LinkTrouble> troubles;
  static constexpr auto fields() {
    return std::tuple{field("node", &LinkTroubles::node, 64), field("troubles", &LinkTroubles::troubles, 256)};
  }
};

/// Answered by a router with what it got: does a message of this size pass both ways?
struct EchoRequest {
  static constexpr std::string_view kSubtype = "echo_request";
  Blob pad;
  static constexpr auto fields() { return std::tuple{field("pad", &EchoRequest::pad, 65536)}; }
};

struct Echo {
  static constexpr std::string_view kSubtype = "echo";
  Blob pad;
  static constexpr auto fields() { return std::tuple{field("pad", &Echo::pad, 65536)}; }
};

/// Four in a lease. `heard` is the sequence last received, so that a one-way cut ends the lease on both sides.
struct KeepAlive {
  static constexpr std::string_view kSubtype = "keep_alive";
  std::uint64_t heard = 0;
  static constexpr auto fields() { return std::tuple{field("heard", &KeepAlive::heard)}; }
};

/// The link is over; the reason is for the log.
struct Goodbye {
  static constexpr std::string_view kSubtype = "goodbye";
  std::string reason;
  static constexpr auto fields() { return std::tuple{field("reason", &Goodbye::reason, 128)}; }
};

struct PeerJoined {
  static constexpr std::string_view kSubtype = "peer_joined";
  std::string id;
  std::uint64_t boot = 0;
  static constexpr auto fields() {
    return std::tuple{field("id", &PeerJoined::id, 64), field("boot", &PeerJoined::boot)};
  }
};

struct PeerExpired {
  static constexpr std::string_view kSubtype = "peer_expired";
  std::string id;
  std::string reason;
  static constexpr auto fields() {
    return std::tuple{field("id", &PeerExpired::id, 64), field("reason", &PeerExpired::reason, 128)};
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
  std::string via;  ///< the relay by which it is reached; empty for a link of one's own
  static constexpr auto fields() {
    return std::tuple{field("id", &Route::id, 64),
                      field("role", &Route::role),
                      field("address", &Route::address, 80),
                      field("state", &Route::state, 32),
                      field("last_heard_s", &Route::last_heard_s),
                      field("boot", &Route::boot),
                      field("link", &Route::link),
                      field("dialled_by", &Route::dialled_by, 64),
                      field("version", &Route::version, 32),
                      field("clock", &Route::clock, 16),
                      field("certificate", &Route::certificate),
                      field("profile", &Route::profile),
                      field("via", &Route::via, 64)};
  }
};

struct RouteTable {
  static constexpr std::string_view kSubtype = "route_table";
  std::string node;
  std::vector<Route> routes;
  static constexpr auto fields() {
    return std::tuple{field("node", &RouteTable::node, 64), field("routes", &RouteTable::routes, 2000)};
  }
};

}  // namespace trb
