// A frame's way through the router: one call decides everything about it. Nothing is copied here. Of a message that is
// not for the router only the header is read.
#pragma once

#include <vector>

#include "services/router/core/link_inbox.hpp"
#include "services/router/core/routing.hpp"
#include "services/router/core/seal_book.hpp"

namespace trb::router {

/// What the shell does with the frame that it handed in: this first, then the effects that came with it, then `each`.
struct FrameOrders {
  Routing way;                       ///< service, peer, lane: the frame goes there. All else is done already
  Outgoing outgoing;                 ///< peer: the frame is numbered, and these seals go with it
  std::vector<ConnectionId> copies;  ///< connections of the bus that get a copy
  std::vector<Routing> each;         ///< peer or lane: each gets a copy, which is not numbered yet
  unsigned shown = 0;                ///< times at the tap
  bool hold = false;                 ///< it and its copies wait until their seal is checked (DeliverHeld)
  const LinkSeals* proof = nullptr;  ///< it belongs into the log of proof, to this link
  bool sealed = false;               ///< it is a seal over what was kept there before
};

class Forwarding {
 public:
  /// `inbox` takes what is for the router itself.
  Forwarding(const LinkParts& parts, CounterTable& counters, LinkInbox& inbox)
      : at_(parts), counters_(counters), inbox_(inbox) {}

  /// A frame of a service or probe. If it leaves by a link, it is numbered in place; on_unsent() if it did not leave.
  FrameOrders from_bus(ConnectionId from, const HeaderView& header, char* frame, std::size_t size, Now now,
                       Effects& out);
  /// A frame that arrived on a link. The shell has proven that it came on that link's own connection (by its socket, or
  /// by routing id and User-Id). on_undelivered() if it could not be sent to its service.
  FrameOrders from_link(LinkId link, const HeaderView& header, BytesView frame, Now now, Effects& out);
  /// The first frame of a connection at the inbox. `key`: the connection's.
  FrameOrders from_stranger(BytesView key, const HeaderView& header, BytesView frame, Now now, Effects& out);
  /// A frame that arrived by the lane that was dialled for this link.
  Routing from_lane(LinkId link, const HeaderView& header, Effects& out) const;

  /// The bus or a link did not take a frame: its sender, on the own bus or behind the link, gets a Nack.
  void on_unsent(ConnectionId from, const HeaderView& header, Errc reason, Effects& out);
  void on_undelivered(LinkId link, const HeaderView& header, Errc reason, Effects& out);
  /// A message that the router made (LinkSend) or relays did not leave; it is told again if it must not be lost.
  void on_own_unsent(const Message& message, Errc reason, Now now, Effects& out);

  /// The held frames of this link, in order: their senders get Nacks, if they can be reached.
  void on_returned(const ReturnHeld& of, const std::vector<HeaderView>& held, Effects& out);
  /// The signature of a seal was checked.
  void on_seal_checked(const CheckSeal& seal, bool good, Now now, Effects& out);

  /// A message for the router itself, from the bus.
  void on_bus_message(ConnectionId from, const Message& message, Now now, Effects& out);

 private:
  void follow(ConnectionId from, const HeaderView& header, char* frame, std::size_t size, Now now, FrameOrders& orders,
              Effects& out);
  void to_link(ConnectionId from, const HeaderView& header, char* frame, std::size_t size, Now now, FrameOrders& orders,
               Effects& out);
  void by_relay(ConnectionId from, std::string_view target, const HeaderView& header, BytesView frame, Now now,
                FrameOrders& orders, Effects& out);
  void to_every_peer(ConnectionId from, const HeaderView& header, BytesView frame, Now now, FrameOrders& orders,
                     Effects& out);
  void lossy_to_every_peer(ConnectionId from, const HeaderView& header, BytesView frame, Now now, FrameOrders& orders,
                           Effects& out);
  Routing route(Link& link, const HeaderView& header, Now now, Effects& out);
  bool receive(LinkId link, const HeaderView& header, BytesView frame, Now now, FrameOrders& orders, Effects& out);
  void to_router(LinkId link, const HeaderView& header, BytesView frame, Now now, FrameOrders& orders, Effects& out);
  void unsealed(LinkId link, const HeaderView& header, FrameOrders& orders, Effects& out);

  LinkParts at_;
  CounterTable& counters_;
  LinkInbox& inbox_;
};

}  // namespace trb::router
