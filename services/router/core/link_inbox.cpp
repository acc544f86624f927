#include "services/router/core/link_inbox.hpp"

#include <utility>

namespace trb::router {
namespace {

/// What a peer is told of why its request was not answered.
Error told_error(const Message& request, const Error& why) {
  const bool named = why.code == Errc::queue_full || request.subtype == HoldInvitation::kSubtype;
  return named ? why : fail(Errc::not_permitted, why.what);
}

bool waits_for_answer(const Message& message) {
  return message.type != MessageType::information && message.reply_to == 0;
}

Nack nack_of(const Message& message, const Error& error) {
  return {std::string(errc_name(error.code)), message.subtype, message.target, error.what, error.hint};
}

}  // namespace

void LinkInbox::on_message(LinkId id, BytesView key, const Message& message, std::uint64_t sequence, Now now,
                           Effects& out) {
  Link* link = at_.table.link(id);
  if (link != nullptr && !key.empty() && key != link->key) return refuse_theft(out);
  if (link == nullptr && at_.trust.refuse_revoked_key(key, now, out)) return;
  if (link == nullptr && at_.table.by_key(key) == nullptr && at_.admission.is_denied(key, now.mono))
    return out.count("refused.denied_key");
  if (message.subtype == Hello::kSubtype) {
    if (const auto carried = at_.handshake.on_hello(id, key, message, sequence, now, out))
      on_carried(*carried, now, out);
    return;
  }
  if (link == nullptr || !link->up) return on_early_message(id, key, message, now, out);
  on_peer_message(*link, message, now, out);
}

void LinkInbox::refuse_theft(Effects& out) {
  out.count("refused.link_theft");
  out.log(LogLevel::warning, "link_theft", "a connection used another one's link id");
}

/// Without a copy of the message.
bool LinkInbox::on_usual(Link& link, const HeaderView& header, Now now, Effects& out) {
  if (header.subtype == Seal::kSubtype) {
    auto seal = decode<Seal>(header.data);
    if (seal) on_seal(link, std::move(*seal), now, out);
    return seal.ok();
  }
  if (header.subtype != KeepAlive::kSubtype) return false;
  const auto alive = decode<KeepAlive>(header.data);
  if (alive) Links::on_keep_alive(link, *alive, now);
  return alive.ok();
}

void LinkInbox::on_seal(const Link& link, Seal seal, Now now, Effects& out) {
  const SealFault fault = at_.seals.close(link.id, std::move(seal), link.heard, out);
  if (fault != SealFault::none) at_.links.break_seal(link.id, link.peer, fault, now, out);
}

void LinkInbox::carry(Link& link, const Hello& hello, Now now, Effects& out) {
  if (const auto carried = at_.handshake.carry(link, hello, now, out)) on_carried(*carried, now, out);
}

/// Notifies every object that handles linked peers.
void LinkInbox::on_carried(const Carried& carried, Now now, Effects& out) {
  Link& link = *at_.table.link(carried.link);
  const Peer& peer = *at_.table.find(link.peer);
  if (carried.new_address) at_.known.on_change(now);
  if (!carried.again) at_.bus.notify(PeerJoined{peer.id, peer.boot}, out);
  at_.profile.send(link, out);
  at_.lanes.open(link, carried.hello, now);
  at_.trust.forget_shown(peer.certificate);
  at_.trust.forget_ended(now);
  at_.updates.send_known(link, carried.hello.revocations, now, out);
  at_.reachable.notify_all(link, out);
  at_.reachable.on_change(peer.id, now);
}

void LinkInbox::on_early_message(LinkId id, BytesView key, const Message& message, Now now, Effects& out) {
  if (Link* link = at_.table.link(id)) return on_dialled_message(*link, message, now, out);
  if (message.subtype == JoinCall::kSubtype && at_.invitations.is_invited(key))
    return on_join_call(id, key, message, now, out);
  // A member's message may have been under way when its link was closed; a stranger's first message must be Hello.
  if (at_.table.by_key(key) != nullptr) return out.count("dropped.closed_link");
  at_.handshake.refuse(
      id, key, fail(Errc::unknown_peer_key, "a connection without a certificate sent " + message.subtype), now, out);
}

/// A node that has a code: it proves only that, and gets the one answer.
void LinkInbox::on_join_call(LinkId id, BytesView key, const Message& message, Now now, Effects& out) {
  const auto call = decode<JoinCall>(message.data);
  const auto answer = call ? at_.invitations.call(key, *call, now, out) : Result<JoinAnswer>(call.error());
  if (answer) return at_.handshake.send(id, *answer, out);
  const std::string code(errc_name(answer.error().code));
  out.count("refused.join_" + code);
  at_.handshake.send(id, Goodbye{code}, out);
}

/// A dialled node sent something else than Hello: it refuses the link.
void LinkInbox::on_dialled_message(Link& link, const Message& message, Now now, Effects& out) {
  // A message before its Goodbye may be what this node needs: its own renewed certificate.
  if (message.subtype == TrustUpdate::kSubtype && !std::exchange(link.told_early, true))
    return at_.updates.on_link_message(link, message, now, out);
  const auto goodbye = decode<Goodbye>(message.data);
  const bool said = message.subtype == Goodbye::kSubtype && goodbye;
  out.count("dial.refused");
  at_.errors.note_link(link.id, said ? "refused_us" : "no_hello", said ? goodbye->reason : "answered without Hello",
                       now);
  at_.links.drop(link.id, said ? "refused: " + goodbye->reason : "answered without Hello", false, now, out);
}

void LinkInbox::on_peer_message(Link& link, const Message& message, Now now, Effects& out) {
  if (message.subtype == TrustUpdate::kSubtype) return at_.updates.on_link_message(link, message, now, out);
  if (message.subtype == NodeProfile::kSubtype) return on_profile(*at_.table.find(link.peer), message.data, now, out);
  const auto body = decode_body(message.subtype, message.data);
  if (!body) return deny(link, message, body.error(), out);
  on_body(link, message, *body, now, out);
}

void LinkInbox::on_body(Link& link, const Message& message, const Body& body, Now now, Effects& out) {
  if (const auto* seal = get_if<Seal>(&body)) {
    on_seal(link, *seal, now, out);
  } else if (const auto* alive = get_if<KeepAlive>(&body)) {
    Links::on_keep_alive(link, *alive, now);
  } else if (const auto* reached = get_if<ReachablePeerList>(&body)) {
    at_.relays.on_reachable(link, *reached, now, out);
  } else if (const auto* relayed = get_if<Relayed>(&body)) {
    on_relayed(link, message, *relayed, now, out);
  } else if (const auto* refused = get_if<RelayRefused>(&body)) {
    at_.relays.on_refused(link, *refused, out);
  } else if (const auto* goodbye = get_if<Goodbye>(&body)) {
    on_goodbye(link, *goodbye, now, out);
  } else {
    on_request(link, message, now, out);
  }
}

void LinkInbox::on_goodbye(const Link& link, const Goodbye& goodbye, Now now, Effects& out) {
  if (goodbye.reason == kUnheard)
    at_.errors.note_link(link.id, "one_way", "this node receives from it, but it does not receive from this node", now);
  at_.links.drop(link.id, "the other side said goodbye: " + goodbye.reason, false, now, out);
}

void LinkInbox::on_request(const Link& link, const Message& message, Now now, Effects& out) {
  const auto body = answer_to(*at_.table.find(link.peer), message, now, out);
  if (body) return answer(link, message, *body, out);
  deny(link, message, told_error(message, body.error()), out);
}

Result<Body> LinkInbox::answer_to(Peer& peer, const Message& message, Now now, Effects& out) {
  if (message.subtype != HoldInvitation::kSubtype) return at_.answers.to_peer(peer, message, now);
  const auto order = decode<HoldInvitation>(message.data);
  if (!order) return order.error();
  auto state = at_.invitations.hold(*order, peer.invitation_checks, now, out);
  return state ? Result<Body>(Body{std::move(*state)}) : Result<Body>(state.error());
}

void LinkInbox::answer(const Link& link, const Message& request, const Body& body, Effects& out) {
  auto message = at_.messages.make(request.source, request.id, body, out);
  if (!message) return;
  Answers::charge(*at_.table.find(link.peer), request, *message);
  out.add(LinkSend{link.id, std::move(*message)});
}

void LinkInbox::deny(const Link& link, const Message& message, const Error& error, Effects& out) {
  out.count("refused." + std::string(errc_name(error.code)));
  out.log(LogLevel::warning, "message_refused", link.peer + " sent " + message.subtype + ": " + error.text());
  if (waits_for_answer(message)) answer(link, message, nack_of(message, error), out);
}

/// A peer's robot and sensors, by its own message. It is passed on beside other rows: none takes the others' room.
void LinkInbox::on_profile(Peer& peer, BytesView data, Now now, Effects& out) {
  if (data.size() <= kMaxProfileSize) {
    auto profile = decode<NodeProfile>(data);
    if (!profile) {
      out.count("refused." + std::string(errc_name(profile.error().code)));
      return out.log(LogLevel::warning, "message_refused", peer.id + " sent node_profile: " + profile.error().text());
    }
    if (fits(*profile)) {
      peer.profile = std::move(*profile);
      return;
    }
  }
  const std::string text = "it told a profile of " + std::to_string(data.size()) + " bytes, " +
                           std::to_string(kMaxProfileSize) + " are the most";
  out.count("refused.profile_too_large");
  out.log(LogLevel::warning, "profile_too_large", peer.id + ": " + text + "; the one before stands");
  at_.errors.note(peer.id, "", "profile_too_large", text, now);
}

// ---- by a relay

void LinkInbox::on_relayed(const Link& link, const Message& message, const Relayed& body, Now now, Effects& out) {
  const auto inner = decode<RelayedFrame>(body.record.payload.bytes);
  if (!inner) return refuse_relayed(link, "malformed", inner.error().text(), out);
  if (inner->target != at_.node.id()) return at_.reachable.pass_on(link, message, body, *inner, now, out);
  const auto unwrapped = at_.relays.receive(link, body, *inner, now, out);
  if (unwrapped) deliver_relayed(*at_.table.find(unwrapped->source), unwrapped->frame, now, out);
}

void LinkInbox::deliver_relayed(Peer& source, BytesView frame, Now now, Effects& out) {
  const auto header = decode_frame(frame);
  if (!header) return;
  out.count("relayed.received");
  if (header->subtype == NodeProfile::kSubtype) return on_profile(source, header->data, now, out);
  const Routing way = at_.routing.from_relay(source, *header, out);
  Message message = to_message(*header);
  const bool may = way.to == Routing::To::service || way.reason == Errc::no_service;
  const std::vector<ConnectionId> copies = may ? at_.bus.copies_for(*header) : std::vector<ConnectionId>{};
  for (const ConnectionId to : copies) out.add(BusSend{to, message});
  if (way.to == Routing::To::service) {
    out.add(BusSend{way.connection, std::move(message)});
  } else if (way.to == Routing::To::router) {
    answer_relayed(source, message, now, out);
  } else if (!copies.empty()) {
    return;
  } else if (const auto nack = at_.messages.nack_elsewhere(*header, way.reason, out)) {
    at_.relays.send(source.id, *nack, now, out);
  }
}

void LinkInbox::answer_relayed(Peer& peer, const Message& request, Now now, Effects& out) {
  auto body = answer_to(peer, request, now, out);
  if (!body) {
    out.count("refused." + std::string(errc_name(body.error().code)));
    if (!waits_for_answer(request)) return;
    body = Body{nack_of(request, told_error(request, body.error()))};
  }
  const auto message = at_.messages.make(peer.id, request.id, *body, out);
  if (!message) return;
  Answers::charge(peer, request, *message);
  at_.relays.send(peer.id, *message, now, out);
}

}  // namespace trb::router
