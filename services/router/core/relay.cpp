// Relays: members that cannot reach each other talk by a third, which both reach. What goes that way signs for itself.
#include <algorithm>

#include "services/router/core/router_core.hpp"

namespace trb::router {
namespace {

constexpr Duration kGather = std::chrono::milliseconds(100);  ///< changes told together: a fleet forms all at once
constexpr std::size_t kMostAtOnce = 64;
constexpr std::size_t kMostBytes = 256U << 10U;
constexpr std::size_t kMaxRelayedFrame = (1U << 19U) - 1024;

std::uint64_t milliseconds_since(MonotonicTime then, Now now) {
  return static_cast<std::uint64_t>(std::max(now.mono - then, Duration{}) / std::chrono::milliseconds(1));
}

Neighbour neighbour_of(const Peer& peer) {
  return {peer.certificate_record, peer.boot, peer.address, peer.version, peer.clock_verified, peer.profile};
}

}  // namespace

// ---- the relay's side: who is reached

void RouterCore::neighbour_changed(const std::string& id, Now now) {
  if (!config_.relay) return;
  changed_neighbours_.insert(id);
  next_neighbours_ = earlier(next_neighbours_, now.mono + kGather);
}

void RouterCore::tell_neighbours(Link& to, const std::set<std::string>& about, Now now, Effects& out) {
  Neighbours told;
  std::size_t bytes = 0;
  const auto send = [&] {
    if (!told.reached.empty() || !told.gone.empty()) link_send(to, told, out);
    told = {};
    bytes = 0;
  };
  for (const std::string& id : about) {
    const auto peer = peers_.find(id);
    if (id == to.peer) continue;
    if (peer == peers_.end()) {
      told.gone.push_back({id, 0});  // put out: revoked
    } else if (peer->second.link == 0) {
      told.gone.push_back({id, milliseconds_since(peer->second.lost.value_or(now.mono), now)});
    } else {
      told.reached.push_back(neighbour_of(peer->second));
      bytes += 1024 + encode(peer->second.profile).size();
    }
    if (told.reached.size() >= kMostAtOnce || told.gone.size() >= kMostAtOnce || bytes >= kMostBytes) send();
  }
  send();
}

/// A new link is told of all that are reached.
void RouterCore::tell_all_neighbours(Link& to, Now now, Effects& out) {
  if (!config_.relay) return;
  std::set<std::string> all;
  for (const auto& [id, peer] : peers_) {
    if (peer.link != 0) all.insert(id);
  }
  tell_neighbours(to, all, now, out);
}

void RouterCore::tick_relay(Now now, Effects& out) {
  if (!next_neighbours_ || now.mono < *next_neighbours_) return;
  next_neighbours_.reset();
  const auto changed = std::exchange(changed_neighbours_, {});
  for (const LinkId id : up_links()) tell_neighbours(links_.at(id), changed, now, out);
}

// ---- everybody else's side: by whom a peer is reached

const Link* RouterCore::relay_of(const Peer& peer) const {
  for (const std::string& id : peer.relays) {
    const auto relay = peers_.find(id);
    const Link* link = relay == peers_.end() ? nullptr : find_link(relay->second.link);
    if (link != nullptr && link->relay) return link;
  }
  return nullptr;
}

void RouterCore::on_neighbours(Link& link, const Neighbours& told, Now now, Effects& out) {
  if (!link.relay) {
    out.count("refused.not_permitted");
    return out.log(LogLevel::warning, "not_permitted", link.peer + " tells of neighbours and is no relay");
  }
  for (const Neighbour& one : told.reached) learn_neighbour(link, one, now, out);
  for (const NeighbourGone& one : told.gone) {
    const auto silent = std::chrono::milliseconds(std::min<std::uint64_t>(one.silent_ms, 3'600'000));
    if (const auto at = peers_.find(one.id); at != peers_.end())
      forget_relay(at->second, link.peer, now.mono - silent, out);
  }
}

void RouterCore::refuse_neighbour(const Link& relay, const Error& error, Effects& out) {
  out.count("refused.neighbour_" + std::string(errc_name(error.code)));
  out.log(LogLevel::warning, "neighbour_refused", "of " + relay.peer + ": " + error.text());
}

void RouterCore::learn_neighbour(const Link& link, const Neighbour& told, Now now, Effects& out) {
  auto certificate = open_member(told.certificate, now, out);
  if (!certificate) return refuse_neighbour(link, certificate.error(), out);
  if (certificate->id == config_.id) return;
  if (Status newest = check_newest(*certificate); !newest) return refuse_neighbour(link, newest.error(), out);
  if (peers_.count(certificate->id) == 0 && peers_.size() >= kMaxPeers)
    return refuse_neighbour(link, fail(Errc::queue_full, "the routing table is full", std::string(kFullCure)), out);
  Peer& peer = make_peer(*certificate, told.certificate);
  const bool reached = peer.link != 0 || relay_of(peer) != nullptr;
  peer.relays.insert(link.peer);
  if (peer.link != 0) return;
  const bool again = peer.met && !peer.expired && peer.boot == told.boot;
  peer.boot = told.boot;
  peer.version = told.version;
  peer.clock_verified = told.clock_verified;
  peer.profile = told.profile;
  peer.met = true;
  peer.expired = false;
  peer.lost.reset();
  if (!told.address.empty()) set_peer_address(peer, told.address, now, out);
  // A link of one's own is better. What keeps it away may be over just now, so the first dials come fast.
  if (!reached) peer.redial.wait = {};
  if (peer.redial.link == 0 && (!peer.redial.at || !reached)) {
    peer.redial = {now.mono + (own_is_smaller(peer.id) ? Duration{} : config_.timing.yield), {}, 0};
  }
  if (!reached) out.log(LogLevel::info, "peer_joined", peer.id + " by way of " + link.peer);
  if (!again) tell_services(PeerJoined{peer.id, peer.boot}, out);
}

/// The relay does not reach it any more, or is not reached itself: the lease runs from its last sign of life.
void RouterCore::forget_relay(Peer& peer, const std::string& relay, MonotonicTime last_sign, Effects& out) {
  if (peer.relays.erase(relay) == 0 || peer.link != 0 || relay_of(peer) != nullptr) return;
  peer.lost = last_sign;
  peer.last_heard = last_sign;
  out.log(LogLevel::info, "route_lost", peer.id + " was reached by " + relay);
}

void RouterCore::relay_lost(const Link& relay, Effects& out) {
  if (!relay.relay) return;
  const MonotonicTime last_sign = std::min(relay.last_heard, relay.confirmed);
  for (auto& [id, peer] : peers_) forget_relay(peer, relay.peer, last_sign, out);
}

std::vector<std::string> RouterCore::relayed_peers() const {
  std::vector<std::string> out;
  for (const auto& [id, peer] : peers_) {
    if (peer.link == 0 && relay_of(peer) != nullptr) out.push_back(id);
  }
  return out;
}

// ---- a message by way of a relay

/// A node that came up without knowing the time would sign what has run out already: it takes the relay's word for it.
UtcTime RouterCore::utc_by(const Link& relay, Now now) const {
  const UtcTime own = checked_utc(now.utc);
  return own == now.utc || !relay.utc_at_zero ? own : std::max(own, {*relay.utc_at_zero + now.mono.ns});
}

Result<Relaying> RouterCore::relay_out(std::string_view target, BytesView frame, std::uint32_t remaining_ms, Now now) {
  const auto at = peers_.find(target);
  const Link* relay = at == peers_.end() ? nullptr : relay_of(at->second);
  if (relay == nullptr) return fail(Errc::peer_unreachable, "no relay reaches '" + std::string(target) + "'");
  if (frame.size() > kMaxRelayedFrame) return fail(Errc::too_large, "over 512 kB by way of a relay");
  Peer& peer = at->second;
  Bytes inner(frame);
  stamp_link(inner.data(), 0, 0, remaining_ms);
  const std::int64_t expires = utc_by(*relay, now).ns + static_cast<std::int64_t>(remaining_ms) * 1'000'000;
  const RelayedFrame body{peer.id, peer.boot, config_.boot, ++peer.relayed_out, expires, {std::move(inner)}};
  Message message;
  message.type = MessageType::information;
  message.subtype = Relayed::kSubtype;
  message.remaining_ms = remaining_ms;
  message.source = config_.id;
  message.target = relay->peer;
  message.id = ++message_count_;
  message.data =
      encode(Relayed{sign(kSignedRelayed, config_.id, config_.authority.id(), encode(body), config_.identity)});
  return Relaying{relay->id, std::move(message)};
}

/// The router's own word to a peer that only a relay reaches.
void RouterCore::send_relayed(const std::string& to, const Message& message, Now now, Effects& out) {
  auto relaying = relay_out(to, encode_frame(message), message.remaining_ms, now);
  if (!relaying) return out.count("dropped." + std::string(errc_name(relaying.error().code)));
  send_on(links_.at(relaying->link), std::move(relaying->message), out);
}

void RouterCore::send_on(Link& link, Message message, Effects& out) {
  out.add(LinkSend{link.id, std::move(message)});
}

void RouterCore::refuse_relayed(const Link& link, std::string_view reason, const std::string& text, Effects& out) {
  out.count("refused.relayed_" + std::string(reason));
  out.log(LogLevel::warning, "relayed_refused", "by " + link.peer + ": " + text);
}

void RouterCore::on_relayed(Link& link, const Message& message, const Relayed& body, Now now, Effects& out) {
  auto inner = decode<RelayedFrame>(body.record.payload.bytes);
  if (!inner) return refuse_relayed(link, "malformed", inner.error().text(), out);
  if (inner->target != config_.id) return pass_on(link, message, body, *inner, out);
  const auto source = peers_.find(body.record.signer);
  if (source == peers_.end()) return refuse_relayed(link, "unknown_signer", "'" + body.record.signer + "'", out);
  if (const auto why = check_relayed(source->second, body.record, *inner, now))
    return refuse_relayed(link, why->first, "of '" + body.record.signer + "': " + why->second, out);
  source->second.relayed_boot = inner->source_boot;
  source->second.relayed_in = inner->count;
  take_relayed(link, source->second, *inner, now, out);
}

/// One hop only: what a link brings to be passed on is its own peer's.
void RouterCore::pass_on(Link& link, const Message& message, const Relayed& body, const RelayedFrame& inner,
                         Effects& out) {
  if (!config_.relay) return refuse_relayed(link, "no_relay", "for '" + inner.target + "': this node is no relay", out);
  if (body.record.signer != link.peer)
    return refuse_relayed(link, "second_hop", "signed by '" + body.record.signer + "'", out);
  const auto target = peers_.find(inner.target);
  if (target == peers_.end() || target->second.link == 0) {
    if (const auto header = decode_frame(inner.frame.bytes))
      nack_peer(link.id, *header, target == peers_.end() ? Errc::unknown_target : Errc::peer_unreachable, out);
    return;
  }
  out.count("relayed.sent");
  Message passed = message;
  passed.source = config_.id;
  passed.target = inner.target;
  passed.id = ++message_count_;
  send_on(links_.at(target->second.link), std::move(passed), out);
}

void RouterCore::not_passed_on(const Message& message, Errc reason, Effects& out) {
  const auto body = decode<Relayed>(message.data);
  const auto inner = body ? decode<RelayedFrame>(body->record.payload.bytes) : Result<RelayedFrame>(body.error());
  const auto source = body ? peers_.find(body->record.signer) : peers_.end();
  const auto header = inner ? decode_frame(inner->frame.bytes) : Result<HeaderView>(inner.error());
  if (!header || source == peers_.end()) return out.count("dropped." + std::string(errc_name(reason)));
  nack_peer(source->second.link, *header, reason, out);
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
  if (inner.target_boot != config_.boot)
    return Why{"other_boot", "meant for boot " + std::to_string(inner.target_boot)};
  if (inner.expires <= utc.ns) return Why{"late", "its time had run out, by this node's clock"};
  const bool newer = std::pair(inner.source_boot, inner.count) > std::pair(source.relayed_boot, source.relayed_in);
  if (!newer) return Why{"replayed", "not newer than one that came"};
  return std::nullopt;
}

void RouterCore::take_relayed(Link& link, const Peer& source, const RelayedFrame& inner, Now now, Effects& out) {
  const auto header = decode_frame(inner.frame.bytes);
  if (!header) return refuse_relayed(link, "malformed", header.error().text(), out);
  if (header->source != source.id)
    return refuse_relayed(link, "source_mismatch", source.id + " signed for '" + std::string(header->source) + "'",
                          out);
  if (header->target != config_.id && header->target != kEveryNode)
    return refuse_relayed(link, "wrong_target", "the message is for '" + std::string(header->target) + "'", out);
  out.count("relayed.received");
  const Routing decision = route_relayed(*header, source.certificate, out);
  Message message = to_message(*header);
  const bool may = decision.to == Routing::To::service || decision.reason == Errc::no_service;
  const std::vector<ConnectionId> hearers = may ? hearers_of(*header) : std::vector<ConnectionId>{};
  for (const ConnectionId hearer : hearers) out.add(BusSend{hearer, message});
  if (decision.to == Routing::To::service) {
    out.add(BusSend{decision.connection, std::move(message)});
  } else if (decision.to == Routing::To::router) {
    answer_relayed(source.id, message, now, out);
  } else if (!hearers.empty()) {
    return;
  } else if (auto nack = nack_relayed(*header, decision.reason, out)) {
    send_relayed(source.id, *nack, now, out);
  }
}

void RouterCore::answer_relayed(const std::string& to, const Message& asked, Now now, Effects& out) {
  const auto body = answer_to(asked, now);
  if (!body) return out.count("refused." + std::string(errc_name(body.error().code)));
  Message message;
  message.type = MessageType::information;
  message.subtype = subtype_of(*body);
  message.source = config_.id;
  message.target = to;
  message.id = ++message_count_;
  message.reply_to = asked.id;
  message.data = encode_body(*body);
  send_relayed(to, message, now, out);
}

}  // namespace trb::router
