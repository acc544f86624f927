#include "services/router/core/relay_routes.hpp"

#include <algorithm>
#include <utility>

#include "common/base/saturate.hpp"
#include "common/security/relay_box.hpp"
#include "services/router/core/nack.hpp"
#include "services/router/core/reachable_peers.hpp"

namespace trb::router {
namespace {

constexpr Duration kLinksFirst = std::chrono::milliseconds(300);  ///< a direct link may be coming up just now
constexpr std::string_view kForged = "bad_signature";
constexpr std::size_t kMaxRelayedFrame = (1U << 19U) - 1024 - kRelayBoxOverhead;

/// A message without its data, for a later answer.
Message header_only(const HeaderView& header) {
  HeaderView view = header;
  view.data = {};
  return to_message(view);
}

}  // namespace

// ---- which way

/// The link to a relay, if it is up.
const Link* RelayRoutes::usable(const std::string& relay) const {
  const Peer* peer = table_.find(relay);
  const Link* link = peer == nullptr ? nullptr : table_.link(peer->link);
  return link != nullptr && link->relay ? link : nullptr;
}

/// The link to the relay that carries this node's messages to the peer; another relay's if that one is gone.
const Link* RelayRoutes::carrier_of(const RelayRoute& route) const {
  if (route.relays.count(route.carrier) != 0) {
    if (const Link* link = usable(route.carrier)) return link;
  }
  for (const std::string& id : route.relays) {
    if (const Link* link = usable(id)) return link;
  }
  return nullptr;
}

const Link* RelayRoutes::relay_of(const Peer& peer) const {
  if (peer.link != 0) return nullptr;
  const RelayRoute& known = routes_.find(peer);
  return known.open ? carrier_of(known) : nullptr;
}

/// Takes the next relay that reaches the peer, in turn: this one has lost a message.
void RelayRoutes::change_carrier(RelayRoute& route) const {
  const Link* now = carrier_of(route);
  if (now == nullptr) return;
  auto next = route.relays.upper_bound(now->peer);
  if (next == route.relays.end()) next = route.relays.begin();
  route.carrier = *next;
}

std::vector<std::string> RelayRoutes::relayed_peers() const {
  std::vector<std::string> out;
  for (const std::string& id : routes_.open()) {
    const Peer* peer = std::as_const(table_).find(id);
    if (peer != nullptr && relay_of(*peer) != nullptr) out.push_back(id);
  }
  return out;
}

void RelayRoutes::on_reachable(const Link& relay, const ReachablePeerList& told, Now now, Effects& out) {
  if (!relay.relay) {
    out.count("refused.not_permitted");
    return out.log(LogLevel::warning, "not_permitted", relay.peer + " tells of neighbours and may not relay");
  }
  for (const SignedRecord& one : told.reached) learn(relay, one, now, out);
  for (const std::string& id : told.gone) {
    if (Peer* peer = table_.find(id)) forget_relay(*peer, relay.peer, out);
  }
}

void RelayRoutes::learn(const Link& relay, const SignedRecord& told, Now now, Effects& out) {
  const auto refuse = [&](const Error& error) {
    out.count("refused.neighbour_" + std::string(errc_name(error.code)));
    out.log(LogLevel::warning, "neighbour_refused", "of " + relay.peer + ": " + error.text());
  };
  Budget& checks = table_.find(relay.peer)->reach_checks;
  if (!trust_.is_known(told) && !checks.take(now.mono)) return out.count("refused.neighbour_too_many");
  auto certificate = trust_.open_member(told, now, out);
  if (!certificate) return refuse(certificate.error());
  if (certificate->id == node_.id()) return;
  if (Status newest = trust_.check_newest(*certificate); !newest) return refuse(newest.error());
  if (!table_.has_room_for(certificate->id))
    return refuse(fail(Errc::queue_full, "the routing table is full", std::string(kFullCure)));
  Peer& peer = table_.learn(*certificate, told);
  RelayRoute& route = routes_.row(peer);
  const bool fresh = route.relays.insert(relay.peer).second;
  if (peer.link == 0 && fresh && !route.open) route.connection.begin(now.mono + kLinksFirst);
}

/// That relay does not reach the peer any more, or is not reached itself.
void RelayRoutes::forget_relay(Peer& peer, const std::string& relay, Effects& out) {
  const auto known = routes_.rows().find(peer.id);
  if (known == routes_.rows().end() || !known->second.relays.contains(relay)) return;
  RelayRoute& route = routes_.row(peer);
  if (route.relays.erase(relay) == 0 || !route.open || carrier_of(route) != nullptr) return;
  leave(peer, peer.id + " was reached by " + relay, out);
}

void RelayRoutes::on_link_lost(Peer& peer, const Link& gone, Now now, Effects& out) {
  RelayRoute& lost = routes_.row(peer);
  if (carrier_of(lost) != nullptr) lost.connection.begin(now.mono);
  if (!gone.relay) return;
  for (const auto& row : routes_.rows()) {
    if (Peer* other = table_.find(row.first)) forget_relay(*other, gone.peer, out);
  }
}

/// The peer cannot be reached that way any more: its lease runs from its last sign of life.
void RelayRoutes::leave(Peer& peer, const std::string& why, Effects& out) {
  RelayRoute& route = routes_.row(peer);
  route.open = false;
  notify_lost(route.connection.take_all(), out);
  if (peer.link != 0) return;
  peer.lost = peer.last_heard = route.connection.last_sign();
  out.log(LogLevel::info, "route_lost", why);
}

/// The peer is there, and knows this node: it is ONLINE by the relay.
void RelayRoutes::join(Peer& peer, const Link& relay, Now now, Effects& out) {
  RelayRoute& route = routes_.row(peer);
  const bool again = peer.met && !peer.expired && peer.boot == route.connection.boot();
  peer.boot = route.connection.boot();
  route.open = true;
  peer.met = true;
  peer.expired = false;
  out.log(LogLevel::info, "peer_joined", peer.id + " by way of " + relay.peer);
  if (!again) bus_.notify(PeerJoined{peer.id, peer.boot}, out);
  send_profile(peer, now, out);
  // A direct link is better. Its obstacle may be gone just now, so the first dials come fast.
  peer.redial.wait = {};
  if (peer.redial.link == 0) links_.redial_soon(peer, now);
}

// ---- out

/// A node that started without the time would sign messages that have already expired: it takes the relay's time.
UtcTime RelayRoutes::utc_by(const Link& relay, Now now) const {
  const UtcTime own = node_.checked_utc(now.utc);
  return own == now.utc || !relay.utc_at_zero ? own : std::max(own, {saturating_add(*relay.utc_at_zero, now.mono.ns)});
}

const Bytes& RelayRoutes::key_of(const Peer& peer, RelayRoute& route) {
  if (route.key.empty()) route.key = relay_key(node_.config().link_key, peer.certificate.link_key.bytes);
  return route.key;
}

Message RelayRoutes::make_relayed(const Peer& peer, const Link& relay, std::uint64_t target_boot, std::uint64_t count,
                                  BytesView frame, std::uint32_t remaining_ms, Now now) {
  const RouterConfig& own = node_.config();
  Bytes plain(frame);
  stamp_link(plain.data(), 0, 0, remaining_ms);
  const std::int64_t expires =
      saturating_add(utc_by(relay, now).ns, static_cast<std::int64_t>(remaining_ms) * 1'000'000);
  const RelayedFrame body{peer.id, target_boot, own.boot,
                          count,   expires,     {lock_relayed(key_of(peer, routes_.row(peer)), plain)}};
  Message message =
      messages_.plain(Relayed::kSubtype, relay.peer,
                      encode(Relayed{sign(kSignedRelayed, own.id, own.authority.id(), encode(body), own.identity)}));
  message.remaining_ms = remaining_ms;
  return message;
}

Result<Relaying> RelayRoutes::wrap(ConnectionId from, std::string_view target, const HeaderView& header,
                                   BytesView frame, Now now) {
  const Peer* peer = table_.find(target);
  const Link* relay = peer == nullptr ? nullptr : relay_of(*peer);
  if (relay == nullptr) return fail(Errc::peer_unreachable, "no relay reaches '" + std::string(target) + "'");
  if (frame.size() > kMaxRelayedFrame) return fail(Errc::too_large, "over 511 kB by way of a relay");
  RelayConnection& connection = routes_.row(*peer).connection;
  const bool waits = deserves_nack(header);
  if (waits && !connection.has_room()) return fail(Errc::queue_full, "too much is unconfirmed by way of a relay");
  const std::uint64_t count = connection.next_count();
  Relaying out{relay->id, make_relayed(*peer, *relay, connection.boot(), count, frame, header.remaining_ms, now)};
  if (waits) connection.remember({count, relay->peer, from, header_only(header), now.mono});
  return out;
}

void RelayRoutes::send(const std::string& to, const Message& message, Now now, Effects& out) {
  auto relaying = wrap(0, to, to_view(message), encode_frame(message), now);
  if (!relaying) return out.count("dropped." + std::string(errc_name(relaying.error().code)));
  out.add(LinkSend{relaying->link, std::move(relaying->message)});
}

void RelayRoutes::not_sent(std::string_view target, std::uint64_t count, Errc reason, Effects& out) {
  const Peer* peer = table_.find(target);
  if (peer == nullptr) return;
  RelayRoute& route = routes_.row(*peer);
  if (const auto question = route.connection.withdraw(count)) return notify_lost(*question, reason, out);
  if (reason == Errc::queue_full) route.told_profile = 0;  // it may have been this node's profile
}

void RelayRoutes::on_refused(const Link& relay, const RelayRefused& told, Effects& out) {
  const Peer* peer = table_.find(told.target);
  if (peer == nullptr || !relay.relay) return out.count("refused.not_permitted");
  RelayRoute& route = routes_.row(*peer);
  const bool full = told.reason == errc_name(Errc::queue_full);
  const Unconfirmed* asked = route.connection.find(told.count);
  if (asked == nullptr) {
    if (full && route.relays.contains(relay.peer)) route.told_profile = 0;  // as in not_sent()
    return;
  }
  // Only the relay that carries the message may report it.
  if (asked->relay != relay.peer) return out.count("refused.not_permitted");
  const auto question = route.connection.withdraw(told.count);
  if (!full) change_carrier(route);
  notify_lost(*question, full ? Errc::queue_full : Errc::peer_unreachable, out);
}

void RelayRoutes::notify_lost(const Unconfirmed& question, Errc reason, Effects& out) {
  if (question.from != 0) return bus_.nack(question.from, to_view(question.asked), reason, out);
  out.count("dropped." + std::string(errc_name(reason)));
}

void RelayRoutes::notify_lost(const std::vector<Unconfirmed>& questions, Effects& out) {
  for (const Unconfirmed& question : questions) {
    out.count("relayed.unconfirmed");
    notify_lost(question, Errc::not_confirmed, out);
  }
}

void RelayRoutes::send_alive(Peer& peer, Now now, Effects& out) {
  RelayRoute& route = routes_.row(peer);
  const Link* relay = carrier_of(route);
  if (relay == nullptr) return route.connection.rest();
  const RouterConfig& config = node_.config();
  RelayAlive own;
  own.address = config.address;
  own.version = config.version;
  own.clock_verified = node_.knows_the_time(now);
  Message alive = messages_.plain(RelayAlive::kSubtype, peer.id,
                                  encode(route.connection.make_alive(std::move(own), node_.random(), now.mono)));
  const auto lease = std::chrono::duration_cast<std::chrono::milliseconds>(config.timing.lease).count();
  alive.remaining_ms = static_cast<std::uint32_t>(lease);
  // For any boot of the peer: the nonce that it repeats proves that it is no replay.
  out.add(LinkSend{relay->id, make_relayed(peer, *relay, 0, route.connection.next_count(), encode_frame(alive),
                                           alive.remaining_ms, now)});
}

/// At a change, but once a second at most: each costs a signature, and the relay's bandwidth.
std::optional<MonotonicTime> RelayRoutes::profile_due(const Peer& peer, const RelayRoute& route) const {
  constexpr Duration kPause = std::chrono::seconds(1);
  if (peer.link != 0 || route.told_profile == profile_.number() || relay_of(peer) == nullptr) return std::nullopt;
  return route.profile_told_at + kPause;
}

void RelayRoutes::send_profile(const Peer& peer, Now now, Effects& out) {
  RelayRoute& route = routes_.row(peer);
  route.told_profile = profile_.number();
  route.profile_told_at = now.mono;
  send(peer.id, messages_.plain(NodeProfile::kSubtype, peer.id, encode(profile_.profile())), now, out);
}

// ---- in

std::optional<Unwrapped> RelayRoutes::receive(const Link& relay, const Relayed& body, const RelayedFrame& inner,
                                              Now now, Effects& out) {
  const auto no = [&](std::string_view reason, const std::string& text) {
    refuse_relayed(relay, reason, text, out);
    return std::nullopt;
  };
  if (!relay.relay) return no("no_right", "it may not relay");
  Peer* source = table_.find(body.record.signer);
  if (source == nullptr) return no("unknown_signer", "'" + body.record.signer + "'");
  const std::string of = "of '" + source->id + "'";
  // Forged names would take every source's share of checks, and the time of all other links.
  Budget& forged = table_.find(relay.peer)->relayed_forged;
  if (!forged.has_left(now.mono)) return no("too_many_forged", of);
  if (!routes_.row(*source).load.try_emplace(relay.peer, kRelayedChecked).first->second.take(now.mono))
    return no("too_many", of);
  if (const auto why = check(*source, body.record, inner, now)) {
    if (why->first == kForged) forged.take(now.mono);
    return no(why->first, of + ": " + why->second);
  }
  auto plain = unlock_relayed(key_of(*source, routes_.row(*source)), inner.box.bytes);
  if (!plain)
    return no(plain.error().code == Errc::wrong_key ? "wrong_key" : "malformed", of + ": " + plain.error().text());
  const auto header = decode_frame(*plain);
  if (!header) return no("malformed", of + ": " + header.error().text());
  if (const auto why = check_ends(*source, *header)) return no(why->first, of + ": " + why->second);
  if (header->subtype == RelayAlive::kSubtype) {
    on_alive(relay, *source, inner, *header, now, out);
    return std::nullopt;
  }
  if (inner.target_boot != node_.config().boot)
    return no("other_boot", of + ": meant for boot " + std::to_string(inner.target_boot));
  if (!routes_.row(*source).connection.take(inner.source_boot, inner.count, deserves_nack(*header), now.mono))
    return no("replayed", of + ": count " + std::to_string(inner.count) + " of boot " +
                              std::to_string(inner.source_boot) + " is not new, or that boot is not proven");
  return Unwrapped{source->id, std::move(*plain)};
}

/// Is it from its signer, and to this node? If not, the reason, as check() gives it.
std::optional<std::pair<std::string_view, std::string>> RelayRoutes::check_ends(const Peer& source,
                                                                                const HeaderView& header) const {
  using Why = std::pair<std::string_view, std::string>;
  if (header.source != source.id) return Why{"source_mismatch", "signed for '" + std::string(header.source) + "'"};
  if (header.target != node_.id() && header.target != kEveryNode)
    return Why{"wrong_target", "the message is for '" + std::string(header.target) + "'"};
  return std::nullopt;
}

/// What a link proves does not hold here: each claim is checked by itself, in this order. The reason is the counter's
/// name.
std::optional<std::pair<std::string_view, std::string>> RelayRoutes::check(const Peer& source,
                                                                           const SignedRecord& record,
                                                                           const RelayedFrame& inner, Now now) const {
  using Why = std::pair<std::string_view, std::string>;
  const UtcTime utc = node_.checked_utc(now.utc);
  if (!verify(record, kSignedRelayed, node_.config().authority.id(), source.certificate.identity_key.bytes))
    return Why{kForged, "the signature is not its own"};
  if (utc.ns >= source.certificate.not_after) return Why{"cert_expired", "its certificate has ended"};
  if (inner.expires <= utc.ns) return Why{"late", "its time had run out, by this node's clock"};
  return std::nullopt;
}

void RelayRoutes::on_alive(const Link& relay, Peer& peer, const RelayedFrame& inner, const HeaderView& header, Now now,
                           Effects& out) {
  const auto alive = decode<RelayAlive>(header.data);
  if (!alive) return refuse_relayed(relay, "malformed", "of '" + peer.id + "': " + alive.error().text(), out);
  if (Status numbers = check_address("address", alive->address, peer.id); !numbers)
    return refuse_relayed(relay, "bad_value", numbers.error().text(), out);
  RelayRoute& route = routes_.row(peer);
  const bool first_relay = route.relays.insert(relay.peer).second;
  if (first_relay && route.carrier.empty()) route.carrier = relay.peer;
  const RelayConnection::Received received =
      route.connection.on_alive(*alive, inner.source_boot, inner.count, now.mono);
  if (!received.lost.empty()) {
    change_carrier(route);
    notify_lost(received.lost, out);
  }
  if (!received.fresh || peer.link != 0) return;
  peer.lost.reset();
  peer.version = alive->version;
  peer.clock_verified = alive->clock_verified;
  if (!alive->address.empty()) links_.set_address(peer, alive->address, now, out);
  if (route.connection.open() && !route.open) join(peer, relay, now, out);
}

// ---- time

void RelayRoutes::tick(Now now, Effects& out) {
  std::set<std::string> due(routes_.untold().begin(), routes_.untold().end());
  for (const std::string& id : routes_.due(now.mono)) due.insert(id);
  for (const std::string& id : due) {
    if (Peer* peer = table_.find(id)) tick_route(*peer, now, out);
  }
  routes_.drop_without_peer();
}

void RelayRoutes::tick_route(Peer& peer, Now now, Effects& out) {
  RelayRoute& route = routes_.row(peer);
  notify_lost(route.connection.overdue(now.mono), out);
  if (route.connection.lapse(now.mono) && route.open) leave(peer, peer.id + " says nothing by any relay", out);
  if (const auto due = profile_due(peer, route); due && now.mono >= *due) send_profile(peer, now, out);
  if (peer.link != 0) {
    route.connection.rest();
  } else if (route.connection.alive_due(now.mono)) {
    if (route.connection.is_unanswered()) change_carrier(route);
    send_alive(peer, now, out);
  }
}

std::optional<MonotonicTime> RelayRoutes::next_deadline() const {
  std::optional<MonotonicTime> next = routes_.earliest();
  for (const std::string& id : routes_.untold()) {
    const Peer* peer = std::as_const(table_).find(id);
    if (peer != nullptr) next = earlier(next, profile_due(*peer, routes_.find(*peer)));
  }
  return next;
}

}  // namespace trb::router
