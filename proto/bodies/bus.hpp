// Bodies of a node's own bus: between a service (or a `trb` probe) and its router.
#pragma once

#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

/// How the note of a service begins that waits for its files; what it waits for comes behind it.
constexpr std::string_view kWaitsNote = "it waits: ";
constexpr std::uint32_t kMaxWaits = kDefaultMaxSize - static_cast<std::uint32_t>(kWaitsNote.size());

/// A service's first message: which subtypes it takes. Answered by ServiceWelcome or a Nack (already_claimed).
struct ServiceHello {
  static constexpr std::string_view kSubtype = "service_hello";
  static constexpr Travel kTravel = on_bus(CostPhase::boot, {kAnyService});
  std::string service;
  std::vector<std::string> subtypes;
  std::uint64_t instance = 0;  ///< random, new at each start of the process
  std::uint32_t pid = 0;
  std::string version;
  std::vector<std::string> hears{};  ///< information that it wants a copy of; any number of services may receive one
  std::string waits{};               ///< why it cannot open its files and refuses all; empty: it works
  template <class T = ServiceHello>
  static FieldTable fields() {
    return FieldTable{field("service", &T::service, 64),   field("subtypes", &T::subtypes, 64),
                      field("instance", &T::instance),     field("pid", &T::pid),
                      field("version", &T::version, 32),   field("hears", &T::hears, 64),
                      field("waits", &T::waits, kMaxWaits)};
  }
};

struct ServiceWelcome {
  static constexpr std::string_view kSubtype = "service_welcome";
  static constexpr Travel kTravel = on_bus(CostPhase::boot);
  std::string node;
  std::string role;
  std::uint16_t slot = 0;  ///< the upper 16 bits of every message id that this connection makes
  std::uint64_t router_instance = 0;
  std::uint64_t boot = 0;  ///< the node's boot counter
  template <class T = ServiceWelcome>
  static FieldTable fields() {
    return FieldTable{field("node", &T::node, 64), field("role", &T::role, 32), field("slot", &T::slot),
                      field("router_instance", &T::router_instance), field("boot", &T::boot)};
  }
};

/// Sent by a service once a second; the answer shows that its router still knows it.
struct ServiceAlive {
  static constexpr std::string_view kSubtype = "service_alive";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {kAnyService});
  std::uint64_t instance = 0;
  std::string note{};  ///< what a person should know of it while it works, such as what it cannot write
  template <class T = ServiceAlive>
  static FieldTable fields() {
    return FieldTable{field("instance", &T::instance), field("note", &T::note)};
  }
};

struct ServiceAliveSeen {
  static constexpr std::string_view kSubtype = "service_alive_seen";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep);
  std::uint64_t router_instance = 0;
  template <class T = ServiceAliveSeen>
  static FieldTable fields() {
    return FieldTable{field("router_instance", &T::router_instance)};
  }
};

/// The router does not know this connection (the router was restarted): send ServiceHello again.
struct HelloWanted {
  static constexpr std::string_view kSubtype = "hello_wanted";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep);
  template <class = void>
  static FieldTable fields() {
    return FieldTable{};
  }
};

/// The negative answer to any command or request, and to information that could not be delivered. Never Nacked itself.
struct Nack {
  static constexpr std::string_view kSubtype = "nack";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string code;     ///< an errc_name()
  std::string subtype;  ///< of the message that failed
  std::string target;   ///< of the message that failed
  std::string what;
  std::string hint;
  std::string about{};  ///< a run's id, or the sensor as it was asked for; empty if nothing depends on it
  template <class T = Nack>
  static FieldTable fields() {
    return FieldTable{field("code", &T::code, 64),   field("subtype", &T::subtype, 64), field("target", &T::target, 64),
                      field("what", &T::what, 1024), field("cure", &T::hint, 1024),     field("about", &T::about, 64)};
  }
};

/// The positive answer to a command.
struct Ack {
  static constexpr std::string_view kSubtype = "ack";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string state;  ///< how far the command has come: "handed_over", "started", "stopped", "released", "accepted"
  std::string text;
  template <class T = Ack>
  static FieldTable fields() {
    return FieldTable{field("state", &T::state, 32), field("text", &T::text, 1024)};
  }
};

/// Requests the router to sign a record of this kind; only the one service that may make this kind is served.
struct SignRequest {
  static constexpr std::string_view kSubtype = "sign_request";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {kAnyService});
  std::string kind;  ///< a kSigned… purpose, proto/bodies/signed.hpp
  Blob payload;
  template <class T = SignRequest>
  static FieldTable fields() {
    return FieldTable{field("kind", &T::kind, 32), field("payload", &T::payload, 1U << 19U)};
  }
};

/// Requests a router's table, which comes in pages: common/actor/route_pages.hpp.
struct RouteListRequest {
  static constexpr std::string_view kSubtype = "route_list";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string after{};  ///< the last row's id of the previous page; empty: the first page
  template <class T = RouteListRequest>
  static FieldTable fields() {
    return FieldTable{field("after", &T::after, 64)};
  }
};

struct ServiceListRequest {
  static constexpr std::string_view kSubtype = "service_list";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  template <class = void>
  static FieldTable fields() {
    return FieldTable{};
  }
};

struct ServiceEntry {
  std::string service;
  std::string state;  ///< "up", "silent" (no message for 3 s), "down"
  std::uint32_t pid = 0;
  std::uint64_t instance = 0;
  std::string version;
  double up_s = 0;
  double last_heard_s = 0;
  std::vector<std::string> subtypes;
  std::string note;  ///< what a person should know about it, such as a certificate that ends soon
  template <class T = ServiceEntry>
  static FieldTable fields() {
    return FieldTable{
        field("service", &T::service, 64),       field("state", &T::state, 16),       field("pid", &T::pid),
        field("instance", &T::instance),         field("version", &T::version, 32),   field("up_s", &T::up_s),
        field("last_heard_s", &T::last_heard_s), field("subtypes", &T::subtypes, 64), field("note", &T::note)};
  }
};

struct ServiceTable {
  static constexpr std::string_view kSubtype = "service_table";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string node;
  std::vector<ServiceEntry> services;
  template <class T = ServiceTable>
  static FieldTable fields() {
    return FieldTable{field("node", &T::node, 64), field("services", &T::services, 32)};
  }
};

/// Requests a router's counters ("sent.SUBTYPE", "refused.REASON" …).
struct RouterCountersRequest {
  static constexpr std::string_view kSubtype = "router_counters";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  template <class = void>
  static FieldTable fields() {
    return FieldTable{};
  }
};

/// The same of the mode-adapter, as earlier versions of trb ask for it. Today's asks by ServiceCountersRequest.
struct AdapterCountersRequest {
  static constexpr std::string_view kSubtype = "adapter_counters";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  template <class = void>
  static FieldTable fields() {
    return FieldTable{};
  }
};

/// Requests the counters of one service of the node. Its name decides who answers: the service itself, or the router.
struct ServiceCountersRequest {
  static constexpr std::string_view kSubtype = "service_counters";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string service;
  template <class T = ServiceCountersRequest>
  static FieldTable fields() {
    return FieldTable{field("service", &T::service, 64)};
  }
};

struct Counter {
  static constexpr std::size_t kLongestName = 128;
  std::string name;
  std::uint64_t value = 0;
  template <class T = Counter>
  static FieldTable fields() {
    return FieldTable{field("name", &T::name, kLongestName), field("value", &T::value)};
  }
};

struct Counters {
  static constexpr std::string_view kSubtype = "counters";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  static constexpr std::size_t kMost = 1024;
  std::string node;
  std::string service;
  std::vector<Counter> values;
  template <class T = Counters>
  static FieldTable fields() {
    return FieldTable{field("node", &T::node, 64), field("service", &T::service, 64),
                      field("values", &T::values, kMost)};
  }
};

/// The router to its services: a peer is linked, or reached through a relay, and was not before.
struct PeerJoined {
  static constexpr std::string_view kSubtype = "peer_joined";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep);
  std::string id;
  std::uint64_t boot = 0;
  template <class T = PeerJoined>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64), field("boot", &T::boot)};
  }
};

/// And: a peer is no longer reached; why, for people.
struct PeerExpired {
  static constexpr std::string_view kSubtype = "peer_expired";
  static constexpr Travel kTravel = on_bus(CostPhase::fail);
  std::string id;
  std::string reason;
  template <class T = PeerExpired>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64), field("reason", &T::reason, 128)};
  }
};

/// Every certificate of that node up to this serial is revoked.
struct RevokedNode {
  std::string id;
  std::uint64_t serial = 0;
  bool operator==(const RevokedNode&) const = default;
  template <class T = RevokedNode>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64), field("serial", &T::serial)};
  }
};

/// The nodes that the list in force revokes, met or not, but for those that are members again: to a service at its
/// welcome, and to all at each new list.
struct RevokedNodes {
  static constexpr std::string_view kSubtype = "revoked_nodes";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep);
  std::vector<RevokedNode> nodes;
  template <class T = RevokedNodes>
  static FieldTable fields() {
    return FieldTable{field("nodes", &T::nodes, 2000)};
  }
};

}  // namespace trb
