// What the router itself answers: its tables, and echoes.
#pragma once

#include <string>

#include "common/actor/counter_table.hpp"
#include "services/router/core/link_errors.hpp"
#include "services/router/core/local_bus.hpp"
#include "services/router/core/membership.hpp"
#include "services/router/core/relay_routes.hpp"
#include "services/router/core/trust_updates.hpp"

namespace trb::router {

class Answers {
 public:
  Answers(const LocalNode& node, const PeerTable& table, const LocalBus& bus, const RelayRoutes& relays,
          const LocalProfile& profile, const CounterTable& counters, const LinkErrors& errors,
          const Membership& membership, const TrustUpdates& updates)
      : node_(node),
        table_(table),
        bus_(bus),
        relays_(relays),
        profile_(profile),
        counters_(counters),
        errors_(errors),
        membership_(membership),
        updates_(updates) {}

  /// This process has started.
  void start(Now now) { started_ = now.mono; }
  /// Errors: bad_value (not for a router), malformed, no_service (whose counters are asked for).
  [[nodiscard]] Result<Body> to_request(const Message& message, Now now) const;
  /// The same for a peer, which gets a bounded number of bytes of tables per second. Errors: queue_full, too.
  Result<Body> to_peer(Peer& peer, const Message& message, Now now) const;
  /// Counts this answer against the peer's bytes.
  static void charge(Peer& peer, const Message& request, const Message& answer);
  /// A page of the table: this node first, then the peers whose ids sort after `after`.
  [[nodiscard]] RouteTable route_table(Now now, const std::string& after = {}) const;
  [[nodiscard]] ServiceTable service_table(Now now) const;

 private:
  [[nodiscard]] Route route_of(const Peer& peer, Now now) const;
  [[nodiscard]] bool gathers(Now now) const;
  [[nodiscard]] Result<Body> service_counters(const Message& message) const;
  [[nodiscard]] ServiceEntry entry_of(const std::string& name, Now now) const;

  const LocalNode& node_;
  const PeerTable& table_;
  const LocalBus& bus_;
  const RelayRoutes& relays_;
  const LocalProfile& profile_;
  const CounterTable& counters_;
  const LinkErrors& errors_;
  const Membership& membership_;
  const TrustUpdates& updates_;
  MonotonicTime started_{};
};

}  // namespace trb::router
