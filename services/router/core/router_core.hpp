// The router's state machine: it owns the objects that hold the state, and hands them each event. Message or time in,
// effects out.
#pragma once

#include <optional>
#include <string>

#include "services/router/core/admission.hpp"
#include "services/router/core/answers.hpp"
#include "services/router/core/beacons.hpp"
#include "services/router/core/forwarding.hpp"
#include "services/router/core/handshake.hpp"
#include "services/router/core/invitations.hpp"
#include "services/router/core/known_addresses.hpp"
#include "services/router/core/lane_table.hpp"
#include "services/router/core/link_inbox.hpp"
#include "services/router/core/links.hpp"
#include "services/router/core/membership.hpp"
#include "services/router/core/reachable_peers.hpp"
#include "services/router/core/relay_routes.hpp"
#include "services/router/core/routing.hpp"
#include "services/router/core/tell_again.hpp"
#include "services/router/core/trust_updates.hpp"

namespace trb::router {

class RouterCore final : private LinkWatcher {
 public:
  explicit RouterCore(RouterConfig config);

  void start(Now now, Effects& out);
  /// The inbox has a new address: links of the old one are dialled again. Empty while the node has none; then `why`
  /// says what is awaited.
  void set_address(const std::string& address, const std::string& why, Now now, Effects& out);
  void set_lane(const std::string& address) { node_.set_lane(address); }
  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  void on_connection_gone(ConnectionId connection, Now now, Effects& out);

  [[nodiscard]] const RouterConfig& config() const { return node_.config(); }
  [[nodiscard]] const PeerTable& table() const { return table_; }

  // ---- the objects to which the shell reports events

  [[nodiscard]] Forwarding& forwarding() { return forwarding_; }  ///< frames
  [[nodiscard]] SealBook& seals() { return seals_; }              ///< what leaves by a link
  [[nodiscard]] LocalBus& bus() { return bus_; }                  ///< services and probes
  [[nodiscard]] LaneTable& lanes() { return lanes_; }             ///< connections of lanes
  [[nodiscard]] Admission& admission() { return admission_; }     ///< keys at the inbox
  [[nodiscard]] Handshake& handshake() { return handshake_; }     ///< dials that have connected
  [[nodiscard]] Links& links() { return links_; }                 ///< connections that have ended
  [[nodiscard]] LinkInbox& inbox() { return inbox_; }             ///< messages without a frame
  [[nodiscard]] Beacons& beacons() { return beacons_; }           ///< datagrams
  [[nodiscard]] TrustUpdates& updates() { return updates_; }      ///< files, and what was stored
  [[nodiscard]] CounterTable& counters() { return counters_; }
  [[nodiscard]] LinkErrors& errors() { return errors_; }
  [[nodiscard]] RelayRoutes& relays() { return relays_; }
  [[nodiscard]] MessageRouting& routing() { return routing_; }
  [[nodiscard]] const Answers& answers() const { return answers_; }

 private:
  void on_link_lost(Peer& peer, const Link& gone, Now now, Effects& out) override;
  [[nodiscard]] bool is_relayed(const Peer& peer) const override;
  [[nodiscard]] LinkParts parts();
  [[nodiscard]] ReportersHeard reporters_heard() const;

  LocalNode node_;
  CounterTable counters_;
  OwnMessages messages_{node_};
  PeerTable table_;
  LinkErrors errors_{table_};
  TrustStore trust_{node_, table_, errors_};
  LocalBus bus_{node_, messages_, trust_};
  SealBook seals_{node_, messages_, counters_};
  LaneTable lanes_{node_, table_};
  KnownAddresses known_{table_};
  LocalProfile profile_{node_, table_, messages_, errors_};
  ReachablePeers reachable_{node_, table_, messages_};
  Admission admission_{node_, table_, trust_};
  Invitations invitations_{node_, admission_};
  Links links_{node_, table_, messages_, seals_, errors_, bus_, trust_, *this};
  Beacons beacons_{node_, table_, trust_, links_, errors_};
  Membership membership_{node_, table_, trust_, links_, beacons_, admission_, errors_};
  TrustUpdates updates_{node_, table_, trust_, membership_, messages_, bus_};
  TellAgain tell_again_{table_, profile_, updates_, reachable_};
  RelayRoutes relays_{node_, table_, trust_, messages_, bus_, profile_, links_};
  Handshake handshake_{node_, table_, admission_, trust_, messages_, seals_, links_, errors_, profile_};
  Answers answers_{node_, table_, bus_, relays_, profile_, counters_, errors_, membership_, updates_};
  MessageRouting routing_{node_, table_, bus_, profile_, relays_, lanes_, counters_};
  LinkInbox inbox_{parts()};
  Forwarding forwarding_{parts(), counters_, inbox_};
};

}  // namespace trb::router
