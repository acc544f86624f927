// Everybody's side of relays: which peers are reached by one, and what goes that way end to end: locked and signed
// here, checked, opened and confirmed there. Between two ends: relay_connection.hpp.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/router/core/link_errors.hpp"
#include "services/router/core/links.hpp"
#include "services/router/core/local_bus.hpp"
#include "services/router/core/local_profile.hpp"
#include "services/router/core/relay_connection.hpp"
#include "services/router/core/trust_store.hpp"

namespace trb::router {

/// What this node knows of the way to one peer by relays.
struct RelayRoute {
  std::uint64_t number = 0;      ///< of the peer: another computer under the same name begins anew
  std::set<std::string> relays;  ///< members that say they reach it
  std::string carrier;           ///< which of them is given what is for it
  bool open = false;             ///< there is no link, but this way is open
  RelayConnection connection;
  Bytes key;                           ///< locks what goes that way; empty until it is needed
  std::uint64_t told_profile = 0;      ///< number of this node's profile that the peer was sent last
  MonotonicTime profile_told_at{};     ///< when
  std::map<std::string, Budget> load;  ///< by relay: what it brings of this peer
};

/// A message that a relay has brought, opened.
struct Unwrapped {
  std::string source;
  Bytes frame;
};

/// route  | event                                               | next
/// -------|-----------------------------------------------------|-------------------------------------------------
/// -      | a relay says that it reaches the peer               | asking: `relay_alive` by it, after 0.3 s
/// asking | the peer's own fresh word that it knows this node   | open: ONLINE by the relay; dialled, for a link is
/// better open   | the relay's link is gone, or it says it is cut off  | open by another relay; else lost, the lease
/// runs open   | nothing of the peer for a lease (expired)           | lost open   | something was lost by the carrier
/// | open; the next relay carries any    | a link with the peer                                | at rest any    | what
/// is forged, late, repeated, for another (invalid) | refused, counted by its reason
class RelayRoutes {
 public:
  RelayRoutes(const LocalNode& node, PeerTable& table, TrustStore& trust, OwnMessages& messages, LocalBus& bus,
              LocalProfile& profile, Links& links)
      : node_(node), table_(table), trust_(trust), messages_(messages), bus_(bus), profile_(profile), links_(links) {}

  /// The relay's link by which the peer is reached now, or nullptr.
  [[nodiscard]] const Link* relay_of(const Peer& peer) const;
  /// Peers that are reached by a relay alone.
  [[nodiscard]] std::vector<std::string> relayed_peers() const;
  /// What is known of the way to that peer; an empty one if nothing is.
  [[nodiscard]] const RelayRoute& route(const Peer& peer) const;

  // ---- relays come and go

  /// A relay's word about whom it reaches. A hint: what a member is it says itself, once it was spoken to.
  void on_reachable(const Link& relay, const ReachablePeerList& told, Now now, Effects& out);
  /// The link that carried the peer's messages is gone: is there another way? And those that it relayed are cut off.
  void on_link_lost(Peer& peer, const Link& gone, Now now, Effects& out);

  // ---- out

  /// A frame of the bus (`from` 0: of the router itself), locked for its target, signed, and addressed to the relay
  /// that reaches it. If who sent it waits for an answer, it is told when nobody confirms that it came. Errors:
  /// too_large (over 511 kB), queue_full (256 unconfirmed), peer_unreachable.
  Result<Relaying> wrap(ConnectionId from, std::string_view target, const HeaderView& header, BytesView frame, Now now);
  /// The router's own message to a peer that only a relay reaches.
  void send(const std::string& to, const Message& message, Now now, Effects& out);
  /// It did not leave by the relay's link.
  void not_sent(std::string_view target, std::uint64_t count, Errc reason, Effects& out);
  /// The relay says that it could not pass it on.
  void on_refused(const Link& relay, const RelayRefused& told, Effects& out);

  // ---- in

  /// What a relay has brought for this node. Nothing: refused, or a word of the two ends.
  std::optional<Unwrapped> receive(const Link& relay, const Relayed& body, const RelayedFrame& inner, Now now,
                                   Effects& out);

  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  RelayRoute& row(const Peer& peer);
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
  std::map<std::string, RelayRoute, std::less<>> rows_;  ///< by peer
};

}  // namespace trb::router
