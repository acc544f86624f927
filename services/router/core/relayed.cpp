// Messages by way of a relay, end to end: locked and signed here, checked, opened and confirmed there.
#include <algorithm>

#include "common/base/saturate.hpp"
#include "common/security/relay_box.hpp"
#include "services/router/core/nack.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {
namespace {

constexpr std::size_t kMaxRelayedFrame = (1U << 19U) - 1024 - kRelayBoxOverhead;

/// A message without its data, to answer it by.
Message header_only(const HeaderView& header) {
  HeaderView view = header;
  view.data = {};
  return to_message(view);
}

HeaderView view_of_header(const Message& message) {
  HeaderView view;
  view.type = message.type;
  view.flags = message.flags;
  view.remaining_ms = message.remaining_ms;
  view.subtype = message.subtype;
  view.source = message.source;
  view.target = message.target;
  view.id = message.id;
  view.reply_to = message.reply_to;
  return view;
}

}  // namespace

/// A node that came up without knowing the time would sign what has run out already: it takes the relay's word for it.
UtcTime RouterCore::utc_by(const Link& relay, Now now) const {
  const UtcTime own = checked_utc(now.utc);
  return own == now.utc || !relay.utc_at_zero ? own : std::max(own, {saturating_add(*relay.utc_at_zero, now.mono.ns)});
}

// ---- out

Message RouterCore::wrap(Peer& peer, const Link& relay, std::uint64_t target_boot, std::uint64_t count, BytesView frame,
                         std::uint32_t remaining_ms, Now now) {
  if (peer.relay_key.empty()) peer.relay_key = relay_key(config_.link_key, peer.certificate.link_key.bytes);
  Bytes plain(frame);
  stamp_link(plain.data(), 0, 0, remaining_ms);
  const std::int64_t expires =
      saturating_add(utc_by(relay, now).ns, static_cast<std::int64_t>(remaining_ms) * 1'000'000);
  const RelayedFrame body{peer.id, target_boot, config_.boot, count, expires, {lock_relayed(peer.relay_key, plain)}};
  Message message;
  message.type = MessageType::information;
  message.subtype = Relayed::kSubtype;
  message.remaining_ms = remaining_ms;
  message.source = config_.id;
  message.target = relay.peer;
  message.id = ++message_count_;
  message.data =
      encode(Relayed{sign(kSignedRelayed, config_.id, config_.authority.id(), encode(body), config_.identity)});
  return message;
}

Result<Relaying> RouterCore::relay_out(ConnectionId from, std::string_view target, const HeaderView& header,
                                       BytesView frame, Now now) {
  const auto at = peers_.find(target);
  const Link* relay = at == peers_.end() ? nullptr : relay_of(at->second);
  if (relay == nullptr) return fail(Errc::peer_unreachable, "no relay reaches '" + std::string(target) + "'");
  if (frame.size() > kMaxRelayedFrame) return fail(Errc::too_large, "over 511 kB by way of a relay");
  Peer& peer = at->second;
  const bool waits = deserves_nack(header);
  if (waits && !peer.road.has_room()) return fail(Errc::queue_full, "too much is unconfirmed by way of a relay");
  const std::uint64_t count = peer.road.next_count();
  Relaying out{relay->id, wrap(peer, *relay, peer.road.boot(), count, frame, header.remaining_ms, now)};
  if (waits) peer.road.remember({count, relay->peer, from, header_only(header), now.mono});
  return out;
}

/// It did not leave, or a relay says that it could not pass it on.
void RouterCore::not_relayed(std::string_view target, std::uint64_t count, Errc reason, Effects& out) {
  const auto peer = peers_.find(target);
  if (peer == peers_.end()) return;
  if (const auto question = peer->second.road.withdraw(count)) tell_lost(*question, reason, out);
}

void RouterCore::on_relay_refused(const Link& link, const RelayRefused& told, Effects& out) {
  const auto peer = peers_.find(told.target);
  if (peer == peers_.end() || !link.relay) return out.count("refused.not_permitted");
  const auto question = peer->second.road.withdraw(told.count);
  if (!question) return;
  // Another relay's word about what this one carries is nobody's.
  if (question->relay != link.peer) {
    peer->second.road.remember(*question);
    return out.count("refused.not_permitted");
  }
  const bool full = told.reason == errc_name(Errc::queue_full);
  if (!full) change_carrier(peer->second);
  tell_lost(*question, full ? Errc::queue_full : Errc::peer_unreachable, out);
}

void RouterCore::tell_lost(const Unconfirmed& question, Errc reason, Effects& out) {
  if (question.from != 0) return nack_local(question.from, view_of_header(question.asked), reason, out);
  out.count("dropped." + std::string(errc_name(reason)));
}

void RouterCore::tell_lost(const std::vector<Unconfirmed>& questions, Effects& out) {
  for (const Unconfirmed& question : questions) {
    out.count("relayed.unconfirmed");
    tell_lost(question, Errc::not_confirmed, out);
  }
}

/// The router's own word to a peer that only a relay reaches.
void RouterCore::send_relayed(const std::string& to, const Message& message, Now now, Effects& out) {
  auto relaying = relay_out(0, to, view_of_header(message), encode_frame(message), now);
  if (!relaying) return out.count("dropped." + std::string(errc_name(relaying.error().code)));
  send_on(links_.at(relaying->link), std::move(relaying->message), out);
}

void RouterCore::say_alive(Peer& peer, Now now, Effects& out) {
  const Link* relay = carrier_of(peer);
  if (relay == nullptr) return peer.road.rest();
  RelayAlive own;
  own.address = config_.address;
  own.version = config_.version;
  own.clock_verified = checked_utc(now.utc) == now.utc;
  Message word;
  word.type = MessageType::information;
  word.subtype = RelayAlive::kSubtype;
  word.source = config_.id;
  word.target = peer.id;
  word.id = ++message_count_;
  word.data = encode(peer.road.make_word(std::move(own), random_u64(), now.mono));
  const auto lease = std::chrono::duration_cast<std::chrono::milliseconds>(config_.timing.lease).count();
  word.remaining_ms = static_cast<std::uint32_t>(lease);
  // For whatever boot it has: what proves that it is no replay is the nonce that it repeats.
  Link& link = links_.at(relay->id);
  send_on(link, wrap(peer, *relay, 0, peer.road.next_count(), encode_frame(word), word.remaining_ms, now), out);
}

void RouterCore::tick_roads(Now now, Effects& out) {
  for (auto& [id, peer] : peers_) {
    tell_lost(peer.road.overdue(now.mono), out);
    if (peer.road.lapse(now.mono) && peer.by_relay) leave_road(peer, id + " says nothing by any relay", out);
    if (const auto due = profile_due(peer); due && now.mono >= *due) tell_profile_by_relay(peer, now, out);
    if (peer.link != 0) {
      peer.road.rest();
    } else if (peer.road.word_due(now.mono)) {
      if (peer.road.unheard()) change_carrier(peer);
      say_alive(peer, now, out);
    }
  }
}

/// The peer is not reached that way any more: the lease runs from its last sign of life.
void RouterCore::leave_road(Peer& peer, const std::string& why, Effects& out) {
  peer.by_relay = false;
  tell_lost(peer.road.take_all(), out);
  if (peer.link != 0) return;
  peer.lost = peer.last_heard = peer.road.last_sign();
  out.log(LogLevel::info, "route_lost", why);
}

// ---- in

void RouterCore::on_relayed(Link& link, const Message& message, const Relayed& body, Now now, Effects& out) {
  auto inner = decode<RelayedFrame>(body.record.payload.bytes);
  if (!inner) return refuse_relayed(link, "malformed", inner.error().text(), out);
  if (inner->target != config_.id) return pass_on(link, message, body, *inner, out);
  if (!link.relay) return refuse_relayed(link, "no_right", "it may not relay", out);
  const auto at = peers_.find(body.record.signer);
  if (at == peers_.end()) return refuse_relayed(link, "unknown_signer", "'" + body.record.signer + "'", out);
  Peer& source = at->second;
  if (!source.carried_by.try_emplace(link.peer, kRelayedChecked).first->second.take(now.mono))
    return refuse_relayed(link, "too_many", "of '" + source.id + "'", out);
  const auto refuse = [&](std::string_view reason, const std::string& text) {
    refuse_relayed(link, reason, "of '" + source.id + "': " + text, out);
  };
  if (const auto why = check_relayed(source, body.record, *inner, now)) return refuse(why->first, why->second);
  if (source.relay_key.empty()) source.relay_key = relay_key(config_.link_key, source.certificate.link_key.bytes);
  const auto plain = unlock_relayed(source.relay_key, inner->box.bytes);
  if (!plain) return refuse(plain.error().code == Errc::wrong_key ? "wrong_key" : "malformed", plain.error().text());
  const auto header = decode_frame(*plain);
  if (!header) return refuse("malformed", header.error().text());
  if (header->source != source.id) return refuse("source_mismatch", "signed for '" + std::string(header->source) + "'");
  if (header->target != config_.id && header->target != kEveryNode)
    return refuse("wrong_target", "the message is for '" + std::string(header->target) + "'");
  if (header->subtype == RelayAlive::kSubtype) return on_relay_alive(link, source, *inner, *header, now, out);
  if (inner->target_boot != config_.boot)
    return refuse("other_boot", "meant for boot " + std::to_string(inner->target_boot));
  if (!source.road.take(inner->source_boot, inner->count, deserves_nack(*header), now.mono))
    return refuse("replayed", "count " + std::to_string(inner->count) + " of boot " +
                                  std::to_string(inner->source_boot) + " is not new, or that boot is not proven");
  take_relayed(source, *header, now, out);
}

/// Nothing that a link proves holds here: each of it is checked on its own, in this order. The reason is the counter's
/// name.
std::optional<std::pair<std::string_view, std::string>> RouterCore::check_relayed(const Peer& source,
                                                                                  const SignedRecord& record,
                                                                                  const RelayedFrame& inner,
                                                                                  Now now) const {
  using Why = std::pair<std::string_view, std::string>;
  const UtcTime utc = checked_utc(now.utc);
  if (!verify(record, kSignedRelayed, config_.authority.id(), source.certificate.identity_key.bytes))
    return Why{"bad_signature", "the signature is not its own"};
  if (utc.ns >= source.certificate.not_after) return Why{"cert_expired", "its certificate has ended"};
  if (inner.expires <= utc.ns) return Why{"late", "its time had run out, by this node's clock"};
  return std::nullopt;
}

void RouterCore::on_relay_alive(const Link& link, Peer& peer, const RelayedFrame& inner, const HeaderView& header,
                                Now now, Effects& out) {
  const auto word = decode<RelayAlive>(header.data);
  if (!word) return refuse_relayed(link, "malformed", "of '" + peer.id + "': " + word.error().text(), out);
  if (Status numbers = check_address("address", word->address, peer.id); !numbers)
    return refuse_relayed(link, "bad_value", numbers.error().text(), out);
  const bool first_relay = peer.relays.insert(link.peer).second;
  if (first_relay && peer.carrier.empty()) peer.carrier = link.peer;
  const RelayRoad::Heard heard = peer.road.hear(*word, inner.source_boot, inner.count, now.mono);
  if (!heard.lost.empty()) {
    change_carrier(peer);
    tell_lost(heard.lost, out);
  }
  if (!heard.fresh || peer.link != 0) return;
  peer.lost.reset();
  peer.version = word->version;
  peer.clock_verified = word->clock_verified;
  if (!word->address.empty()) set_peer_address(peer, word->address, now, out);
  if (peer.road.open() && !peer.by_relay) join_by_relay(peer, link, now, out);
}

/// The peer is there, and knows this node: it is ONLINE by the relay.
void RouterCore::join_by_relay(Peer& peer, const Link& relay, Now now, Effects& out) {
  const bool again = peer.met && !peer.expired && peer.boot == peer.road.boot();
  peer.boot = peer.road.boot();
  peer.by_relay = true;
  peer.met = true;
  peer.expired = false;
  out.log(LogLevel::info, "peer_joined", peer.id + " by way of " + relay.peer);
  if (!again) tell_services(PeerJoined{peer.id, peer.boot}, out);
  tell_profile_by_relay(peer, now, out);
  // A link of one's own is better. What keeps it away may be over just now, so the first dials come fast.
  peer.redial.wait = {};
  if (peer.redial.link == 0)
    peer.redial = {now.mono + (own_is_smaller(peer.id) ? Duration{} : config_.timing.yield), {}, 0};
}

/// At a change, but once a second at most: each costs a signature, and a relay's bandwidth.
std::optional<MonotonicTime> RouterCore::profile_due(const Peer& peer) const {
  constexpr Duration kPause = std::chrono::seconds(1);
  if (peer.link != 0 || peer.told_profile == profile_number_ || relay_of(peer) == nullptr) return std::nullopt;
  return peer.profile_told_at + kPause;
}

void RouterCore::tell_profile_by_relay(Peer& peer, Now now, Effects& out) {
  peer.told_profile = profile_number_;
  peer.profile_told_at = now.mono;
  Message message;
  message.type = MessageType::information;
  message.subtype = NodeProfile::kSubtype;
  message.source = config_.id;
  message.target = peer.id;
  message.id = ++message_count_;
  message.data = encode(profile_);
  send_relayed(peer.id, message, now, out);
}

/// Of a peer's robot and sensors, by its own word. It is told on, row beside row: none takes the others' room.
void RouterCore::take_profile(Peer& peer, BytesView data, Now now, Effects& out) {
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
  troubles_.note(peer.id, "", "profile_too_large", text, now.mono);
}

void RouterCore::take_relayed(Peer& source, const HeaderView& header, Now now, Effects& out) {
  out.count("relayed.received");
  if (header.subtype == NodeProfile::kSubtype) return take_profile(source, header.data, now, out);
  const Routing decision = route_relayed(header, source.certificate, out);
  Message message = to_message(header);
  const bool may = decision.to == Routing::To::service || decision.reason == Errc::no_service;
  const std::vector<ConnectionId> hearers = may ? hearers_of(header) : std::vector<ConnectionId>{};
  for (const ConnectionId hearer : hearers) out.add(BusSend{hearer, message});
  if (decision.to == Routing::To::service) {
    out.add(BusSend{decision.connection, std::move(message)});
  } else if (decision.to == Routing::To::router) {
    answer_relayed(source.id, message, now, out);
  } else if (!hearers.empty()) {
    return;
  } else if (auto nack = nack_relayed(header, decision.reason, out)) {
    send_relayed(source.id, *nack, now, out);
  }
}

void RouterCore::answer_relayed(const std::string& to, const Message& asked, Now now, Effects& out) {
  Peer& peer = peers_.at(to);
  const auto body = answer_peer(peer, asked, now);
  if (!body) return out.count("refused." + std::string(errc_name(body.error().code)));
  if (const auto message = make_own(to, asked.id, *body, out)) {
    if (asked.subtype != EchoRequest::kSubtype) peer.answers.spend(message->data.size());
    send_relayed(to, *message, now, out);
  }
}

}  // namespace trb::router
