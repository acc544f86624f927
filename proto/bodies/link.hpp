// Bodies between routers, and what a router knows of the fleet.
#pragma once

#include "proto/bodies/signed.hpp"
#include "proto/field.hpp"

namespace trb {

struct ParameterInfo {
  std::string name;
  std::string type;  ///< "number", "integer", "text", "bool", "place", "numbers"
  bool required = true;
  std::string unit;  ///< SI; empty for none
  bool operator==(const ParameterInfo&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("name", &ParameterInfo::name, 64), field("type", &ParameterInfo::type, 16),
                      field("required", &ParameterInfo::required), field("unit", &ParameterInfo::unit, 16)};
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
  bool operator==(const NodeProfile&) const = default;
  static constexpr auto fields() {
    return std::tuple{
        field("framework", &NodeProfile::framework, 64), field("mode", &NodeProfile::mode, 16),
        field("transport", &NodeProfile::transport, 16), field("maker", &NodeProfile::maker, 64),
        field("model", &NodeProfile::model, 64),         field("capabilities", &NodeProfile::capabilities, 64),
        field("sensors", &NodeProfile::sensors, 255),    field("skills", &NodeProfile::skills, 128),
        field("places", &NodeProfile::places, 255),      field("robot", &NodeProfile::robot, 32),
        field("detail", &NodeProfile::detail, 255),      field("fenced", &NodeProfile::fenced)};
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
  static constexpr auto fields() {
    return std::tuple{field("certificate", &Hello::certificate),
                      field("boot", &Hello::boot),
                      field("address", &Hello::address, 80),
                      field("version", &Hello::version, 32),
                      field("utc", &Hello::utc),
                      field("clock_verified", &Hello::clock_verified),
                      field("profile", &Hello::profile)};
  }
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
                      field("profile", &Route::profile)};
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
