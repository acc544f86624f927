// Where a message goes: decided by its header alone; nothing is copied.
#pragma once

#include <string_view>

#include "common/actor/counter_table.hpp"
#include "services/router/core/lane_table.hpp"
#include "services/router/core/local_bus.hpp"
#include "services/router/core/local_profile.hpp"
#include "services/router/core/relay_routes.hpp"

namespace trb::router {

/// from      | for                                       | goes to
/// ----------|-------------------------------------------|----------------------------------------------------------
/// bus       | this node, the router's own subtype       | router
/// any       | this node, an answer                      | the requesting connection, if the sender was asked
/// any       | this node, a claimed subtype              | the service that claims it
/// any       | this node, a plugged sensor's, a request  | the sensor-bus
/// any       | this node, another subtype of a user      | the mode-adapter
/// bus       | a peer that is linked                     | its link; what may be lost: its lane, a little by its link
/// bus       | a peer that a relay reaches               | that relay
/// bus       | every node, information                   | every peer
/// any       | what its sender may not send (invalid)    | dropped: not_permitted
/// any       | a message whose time is over (expired)    | dropped: expired
class MessageRouting {
 public:
  MessageRouting(const LocalNode& node, PeerTable& table, LocalBus& bus, LocalProfile& profile, RelayRoutes& relays,
                 LaneTable& lanes, CounterTable& counters)
      : node_(node), table_(table), bus_(bus), profile_(profile), relays_(relays), lanes_(lanes), counters_(counters) {}

  /// A message of a service or probe. Refused ones are dropped with a reason.
  Routing from_bus(ConnectionId from, const HeaderView& header);
  /// A message that arrived in sequence on a link that is up.
  Routing from_link(const Link& link, const HeaderView& header, Effects& out) const;
  /// A message from this peer that a relay has brought.
  Routing from_relay(const Peer& source, const HeaderView& header, Effects& out) const;
  /// A message that arrived by the lane dialled for this link: goes only to a service, or is dropped and counted here.
  Routing from_lane(LinkId link, const HeaderView& header, Effects& out) const;
  /// How lossy information leaves for a peer: by the lane if the peer listens there; else as other messages do, while
  /// that is little; else it is dropped and counted.
  Routing lossy(std::string_view to, std::size_t size, Now now);

 private:
  [[nodiscard]] Routing to_self(const HeaderView& header, Party from) const;
  [[nodiscard]] std::optional<ConnectionId> counting_service(const HeaderView& header) const;
  [[nodiscard]] Routing to_router_or_service(const HeaderView& header) const;
  Routing from_bus_to_self(ConnectionId from, const Connection& by, const HeaderView& header);
  Routing from_bus_to_peer(ConnectionId from, const HeaderView& header);
  [[nodiscard]] Routing from_peer(const Peer& peer, const HeaderView& header, Effects& out) const;

  const LocalNode& node_;
  PeerTable& table_;
  LocalBus& bus_;
  LocalProfile& profile_;
  RelayRoutes& relays_;
  LaneTable& lanes_;
  CounterTable& counters_;
};

}  // namespace trb::router
