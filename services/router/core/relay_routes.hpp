// Every node's side of relays: which peers a relay reaches, and what goes that way end to end: encrypted and signed
// here; checked, decrypted and confirmed there. Between two ends: relay_connection.hpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/router/core/link_errors.hpp"
#include "services/router/core/links.hpp"
#include "services/router/core/local_bus.hpp"
#include "services/router/core/local_profile.hpp"
#include "services/router/core/relay_table.hpp"
#include "services/router/core/trust_store.hpp"

namespace trb::router {

/// A message that a relay has brought, decrypted.
struct Unwrapped {
  std::string source;
  Bytes frame;
};

/// route  | event                                              | next
/// -------|----------------------------------------------------|--------------------------------------------------
/// -      | a relay reports that it reaches the peer           | asking: `relay_alive` by it, after 0.3 s
/// asking | the peer's own fresh word that it knows this node  | open: ONLINE by the relay; dialled: links are better
/// open   | the relay's link ends, or it lost the peer         | open by another relay; else lost, the lease runs
/// open   | the peer is silent for a lease (expired)           | lost
/// open   | the carrier lost a message                         | open; the next relay carries
/// any    | a link with the peer                               | at rest
/// any    | forged, late, repeated, for another node (invalid) | refused, counted by its reason
class RelayRoutes {
 public:
  RelayRoutes(const LocalNode& node, PeerTable& table, TrustStore& trust, OwnMessages& messages, LocalBus& bus,
              LocalProfile& profile, Links& links)
      : node_(node),
        table_(table),
        trust_(trust),
        messages_(messages),
        bus_(bus),
        profile_(profile),
        links_(links),
        routes_(node, table, profile) {}

  /// The link to the relay by which the peer is reached now, or nullptr.
  [[nodiscard]] const Link* relay_of(const Peer& peer) const;
  /// Peers that only a relay reaches.
  [[nodiscard]] std::vector<std::string> relayed_peers() const;
  /// What is known about the way to that peer; empty if nothing is.
  [[nodiscard]] const RelayRoute& route(const Peer& peer) const { return routes_.find(peer); }

  // ---- relays come and go

  /// A relay's list of the peers that it reaches. A hint: each peer itself proves who it is once it is contacted.
  void on_reachable(const Link& relay, const ReachablePeerList& told, Now now, Effects& out);
  /// The peer's link is gone: is there another way? The peers that it relayed are cut off.
  void on_link_lost(Peer& peer, const Link& gone, Now now, Effects& out);

  // ---- out

  /// Encrypts a frame of the bus (`from` 0: of the router itself) for its target, signs it, and addresses it to the
  /// relay that reaches the target. Its sender, if it waits for an answer, is notified if the arrival is not confirmed.
  /// Errors: too_large (over 511 kB), queue_full (256 unconfirmed), peer_unreachable.
  Result<Relaying> wrap(ConnectionId from, std::string_view target, const HeaderView& header, BytesView frame, Now now);
  /// Sends the router's own message to a peer that only a relay reaches.
  void send(const std::string& to, const Message& message, Now now, Effects& out);
  /// It did not leave by the relay's link.
  void not_sent(std::string_view target, std::uint64_t count, Errc reason, Effects& out);
  /// The relay reports that it could not pass a frame on.
  void on_refused(const Link& relay, const RelayRefused& told, Effects& out);

  // ---- in

  /// What a relay has brought for this node. Nothing: refused, or a message between the two routers themselves.
  std::optional<Unwrapped> receive(const Link& relay, const Relayed& body, const RelayedFrame& inner, Now now,
                                   Effects& out);

  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  void tick_route(Peer& peer, Now now, Effects& out);
  const Bytes& key_of(const Peer& peer, RelayRoute& route);
  [[nodiscard]] const Link* carrier_of(const RelayRoute& route) const;
  [[nodiscard]] const Link* usable(const std::string& relay) const;
  void change_carrier(RelayRoute& route) const;
  void learn(const Link& relay, const SignedRecord& told, Now now, Effects& out);
  void forget_relay(Peer& peer, const std::string& relay, Effects& out);
  void leave(Peer& peer, const std::string& why, Effects& out);
  void join(Peer& peer, const Link& relay, Now now, Effects& out);

  [[nodiscard]] UtcTime utc_by(const Link& relay, Now now) const;
  Message make_relayed(const Peer& peer, const Link& relay, std::uint64_t target_boot, std::uint64_t count,
                       BytesView frame, std::uint32_t remaining_ms, Now now);
  void send_alive(Peer& peer, Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> profile_due(const Peer& peer, const RelayRoute& route) const;
  void send_profile(const Peer& peer, Now now, Effects& out);
  void notify_lost(const Unconfirmed& question, Errc reason, Effects& out);
  void notify_lost(const std::vector<Unconfirmed>& questions, Effects& out);

  [[nodiscard]] std::optional<std::pair<std::string_view, std::string>> check_ends(const Peer& source,
                                                                                   const HeaderView& header) const;
  [[nodiscard]] std::optional<std::pair<std::string_view, std::string>> check(const Peer& source,
                                                                              const SignedRecord& record,
                                                                              const RelayedFrame& inner, Now now) const;
  void on_alive(const Link& relay, Peer& peer, const RelayedFrame& inner, const HeaderView& header, Now now,
                Effects& out);

  const LocalNode& node_;
  PeerTable& table_;
  TrustStore& trust_;
  OwnMessages& messages_;
  LocalBus& bus_;
  LocalProfile& profile_;
  Links& links_;
  RelayTable routes_;
};

}  // namespace trb::router
