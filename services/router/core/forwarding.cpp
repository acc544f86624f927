#include "services/router/core/forwarding.hpp"

#include <algorithm>
#include <utility>

#include "services/router/core/nack.hpp"

namespace trb::router {

using To = Routing::To;

// ---- from the bus

FrameOrders Forwarding::from_bus(ConnectionId from, const HeaderView& header, char* frame, std::size_t size, Now now,
                                 Effects& out) {
  FrameOrders orders;
  orders.way = at_.routing.from_bus(from, header);
  const bool leaves = orders.way.to == To::peer || orders.way.to == To::relay;
  if (leaves && is_lossy(header)) orders.way = at_.routing.lossy(header.target, size, now);
  // If a sender may send lossy information, it gets no Nack when that is dropped.
  if (orders.way.to == To::drop && !leaves) at_.bus.nack(from, header, orders.way.reason, out);
  follow(from, header, frame, size, now, orders, out);
  return orders;
}

/// Does what the message's way requires.
void Forwarding::follow(ConnectionId from, const HeaderView& header, char* frame, std::size_t size, Now now,
                        FrameOrders& orders, Effects& out) {
  switch (orders.way.to) {
    case To::peer:
      return to_link(from, header, frame, size, now, orders, out);
    case To::relay:
      return by_relay(from, header.target, header, {frame, size}, now, orders, out);
    case To::lane:
    case To::service:
      orders.shown = 1;
      return;
    case To::every_peer:
      if (is_lossy(header)) return lossy_to_every_peer(from, header, {frame, size}, now, orders, out);
      return to_every_peer(from, header, {frame, size}, now, orders, out);
    case To::router:
      return on_bus_message(from, to_message(header), now, out);
    case To::drop:
      return;
  }
}

void Forwarding::to_link(ConnectionId from, const HeaderView& header, char* frame, std::size_t size, Now now,
                         FrameOrders& orders, Effects& out) {
  const LinkId link = orders.way.link;
  const auto& has_room = at_.node.config().has_room;
  if (has_room && !has_room(link, size)) {
    orders.way = {.reason = Errc::queue_full};
    return at_.bus.nack(from, header, Errc::queue_full, out);
  }
  orders.shown = 1;
  orders.outgoing = at_.seals.send(link, frame, size, now);
}

void Forwarding::by_relay(ConnectionId from, std::string_view target, const HeaderView& header, BytesView frame,
                          Now now, FrameOrders& orders, Effects& out) {
  auto relaying = at_.relays.wrap(from, target, header, frame, now);
  if (!relaying) return at_.bus.nack(from, header, relaying.error().code, out);
  ++orders.shown;
  out.add(LinkSend{relaying->link, std::move(relaying->message)});
}

void Forwarding::to_every_peer(ConnectionId from, const HeaderView& header, BytesView frame, Now now,
                               FrameOrders& orders, Effects& out) {
  orders.copies = at_.bus.copies_for(header);
  std::erase(orders.copies, from);
  for (const std::string& peer : at_.relays.relayed_peers()) by_relay(from, peer, header, frame, now, orders, out);
  for (const LinkId link : at_.table.up_links()) orders.each.push_back({.to = To::peer, .link = link});
}

void Forwarding::lossy_to_every_peer(ConnectionId from, const HeaderView& header, BytesView frame, Now now,
                                     FrameOrders& orders, Effects& out) {
  for (const auto& [id, peer] : at_.table.peers()) {
    const Routing way = at_.routing.lossy(id, frame.size(), now);
    if (way.to == To::relay) by_relay(from, id, header, frame, now, orders, out);
    if (way.to == To::peer || way.to == To::lane) orders.each.push_back(way);
  }
}

void Forwarding::on_unsent(ConnectionId from, const HeaderView& header, Errc reason, Effects& out) {
  at_.bus.nack(from, header, reason, out);
}

void Forwarding::on_bus_message(ConnectionId from, const Message& message, Now now, Effects& out) {
  const Connection* connection = at_.bus.services().find(from);
  if (connection == nullptr) return;
  at_.bus.on_received(from, now);
  const auto body = decode_body(message.subtype, message.data);
  if (!body) return at_.bus.deny(from, message, body.error(), out);
  const std::string_view service =
      connection->member == Member::service ? connection->hello.service : std::string_view();
  if (const auto* alive = get_if<ServiceAlive>(&*body)) {
    at_.bus.on_note(from, alive->note);
    at_.bus.answer(from, message, ServiceAliveSeen{at_.node.config().instance}, out);
  } else if (const auto* request = get_if<SignRequest>(&*body)) {
    at_.bus.sign_for(from, message, *request, out);
  } else if (const auto* update = get_if<TrustUpdate>(&*body)) {
    at_.updates.on_bus_request(from, message, *update, now, out);
  } else if (const auto* order = get_if<HoldInvitation>(&*body)) {
    const auto state = at_.invitations.hold_own(*order, now, out);
    if (!state) return at_.bus.deny(from, message, state.error(), out);
    at_.bus.answer(from, message, *state, out);
  } else if (const auto* profile = get_if<NodeProfile>(&*body)) {
    if (service == kModeAdapter) at_.profile.on_robot(*profile, now, out);
  } else if (const auto* sensors = get_if<NodeSensors>(&*body)) {
    if (service == kSensorBus) at_.profile.on_sensors(*sensors, out);
  } else if (const auto answer = at_.answers.to_request(message, now)) {
    at_.bus.answer(from, message, *answer, out);
  } else {
    at_.bus.deny(from, message, answer.error(), out);
  }
}

// ---- from a link

FrameOrders Forwarding::from_link(LinkId id, const HeaderView& header, BytesView frame, Now now, Effects& out) {
  FrameOrders orders;
  Link* link = at_.table.link(id);
  orders.way = link == nullptr ? Routing{.reason = Errc::unknown_peer_key} : route(*link, header, now, out);
  link = at_.table.link(id);
  const bool was_up = link != nullptr && link->up;
  if (was_up && !receive(id, header, frame, now, orders, out)) {
    unsealed(id, header, orders, out);
    return orders;
  }
  if (orders.way.to == To::service || orders.way.reason == Errc::no_service) orders.copies = at_.bus.copies_for(header);
  orders.hold = at_.seals.holds(id);
  orders.shown = orders.way.to != To::drop || !orders.copies.empty() ? 1 : 0;
  if (orders.way.to == To::router) {
    to_router(id, header, frame, now, orders, out);
  } else if (orders.way.to == To::drop && orders.copies.empty()) {
    on_undelivered(id, header, orders.way.reason, out);
  }
  return orders;
}

/// Its sequence number and its source are checked first.
Routing Forwarding::route(Link& link, const HeaderView& header, Now now, Effects& out) {
  const LinkId id = link.id;
  if (!at_.links.receive(link, header, now, out)) return {.reason = Errc::conflict};
  if (!link.up) return {.to = To::router};
  if (header.source != link.peer) {
    out.log(LogLevel::warning, "source_mismatch",
            "link of " + link.peer + " carried source " + std::string(header.source));
    return {.reason = Errc::source_mismatch};
  }
  if (const auto hello = std::exchange(link.waiting, nullptr)) {
    inbox_.carry(link, *hello, now, out);
    if (at_.table.link(id) == nullptr) return {.reason = Errc::conflict};
  }
  return at_.routing.from_link(link, header, out);
}

/// Adds the frame to the running hash of its link, and to the log of proof. False: the link was closed because of it.
bool Forwarding::receive(LinkId id, const HeaderView& header, BytesView frame, Now now, FrameOrders& orders,
                         Effects& out) {
  const Link* link = at_.table.link(id);
  if (link == nullptr || !link->up) return link != nullptr;
  orders.proof = at_.seals.find(id);
  const SealFault fault = at_.seals.receive(id, header, frame);
  if (fault != SealFault::none) at_.links.break_seal(id, link->peer, fault, now, out);
  return at_.table.link(id) != nullptr;
}

void Forwarding::to_router(LinkId id, const HeaderView& header, BytesView frame, Now now, FrameOrders& orders,
                           Effects& out) {
  Link& link = *at_.table.link(id);
  const bool was_up = link.up;
  // The dialling side's proof is the pinned server key.
  const Bytes key = was_up ? Bytes() : link.key;
  if (!was_up || !inbox_.on_usual(link, header, now, out))
    inbox_.on_message(id, key, to_message(header), header.sequence, now, out);
  if (!was_up) receive(id, header, frame, now, orders, out);
  orders.sealed = header.subtype == Seal::kSubtype && at_.table.link(id) != nullptr;
}

/// This frame was one too many: its sender gets the Nack before the Goodbye.
void Forwarding::unsealed(LinkId id, const HeaderView& header, FrameOrders& orders, Effects& out) {
  auto nack = orders.way.to == To::service ? at_.messages.nack_elsewhere(header, Errc::seal_broken, out) : std::nullopt;
  if (nack) out.list.insert(out.list.begin(), LinkSend{id, std::move(*nack)});
  orders.way = {.reason = Errc::seal_broken};
}

FrameOrders Forwarding::from_stranger(BytesView key, const HeaderView& header, BytesView frame, Now now, Effects& out) {
  FrameOrders orders;
  if (at_.table.link(header.link) != nullptr) {
    // Also the peer itself: on another connection nothing would be counted, sealed or kept as proof.
    LinkInbox::refuse_theft(out);
    return orders;
  }
  inbox_.on_message(header.link, key, to_message(header), header.sequence, now, out);
  receive(header.link, header, frame, now, orders, out);
  return orders;
}

Routing Forwarding::from_lane(LinkId link, const HeaderView& header, Effects& out) const {
  return at_.routing.from_lane(link, header, out);
}

void Forwarding::on_undelivered(LinkId id, const HeaderView& header, Errc reason, Effects& out) {
  const Link* link = at_.table.link(id);
  const bool told = link != nullptr && link->up && header.source == link->peer;
  if (!told) return out.count(undelivered_counter(reason));
  if (auto nack = at_.messages.nack_elsewhere(header, reason, out)) out.add(LinkSend{id, std::move(*nack)});
}

void Forwarding::on_own_unsent(const Message& message, Errc reason, Now now, Effects& out) {
  if (message.subtype != Relayed::kSubtype) {
    at_.tell_again.on_unsent(message, now);
    return counters_.count(reason == Errc::queue_full ? "dropped.queue_full" : "dropped.closed_link");
  }
  out.count("dropped." + std::string(errc_name(reason)));
  const auto body = decode<Relayed>(message.data);
  const auto inner = body ? decode<RelayedFrame>(body->record.payload.bytes) : Result<RelayedFrame>(body.error());
  if (!inner) return;
  if (body->record.signer == at_.node.id()) return at_.relays.not_sent(inner->target, inner->count, reason, out);
  const Peer* source = at_.table.find(body->record.signer);
  const Link* link = source == nullptr ? nullptr : at_.table.link(source->link);
  if (link != nullptr) at_.reachable.refuse(*link, *inner, reason, out);
}

// ---- seals

void Forwarding::on_seal_checked(const CheckSeal& seal, bool good, Now now, Effects& out) {
  if (good) return at_.seals.proven(seal, out);
  at_.links.break_seal(seal.link, seal.signer->id, SealFault::wrong_signature, now, out);
}

void Forwarding::on_returned(const ReturnHeld& of, const std::vector<HeaderView>& held, Effects& out) {
  std::size_t messages = 0;
  std::uint64_t last = 0;
  for (const HeaderView& header : held) {
    // Some have copies, for services that want one.
    if (std::exchange(last, header.sequence) == header.sequence) continue;
    ++messages;
    auto nack = at_.messages.nack_elsewhere(header, Errc::seal_broken, out);
    if (nack && of.may_send) out.add(LinkSend{of.link, std::move(*nack)});
  }
  if (messages == 0) return;
  out.log(LogLevel::warning, "undelivered",
          std::to_string(messages) + " messages of " + of.peer +
              " waited for their seal and are not delivered: " + of.why + (of.may_send ? "" : "; it cannot be told"));
}

}  // namespace trb::router
