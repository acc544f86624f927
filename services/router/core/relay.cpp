// Relays: members that cannot reach each other talk by a third, which both reach and which may relay. Here: whom a
// relay reaches, by which relay a peer is reached, and what a relay passes on.
#include <algorithm>

#include "services/router/core/router_core.hpp"

namespace trb::router {
namespace {

constexpr Duration kGather = std::chrono::milliseconds(100);      ///< changes told together: a fleet forms all at once
constexpr Duration kLinksFirst = std::chrono::milliseconds(300);  ///< a link of one's own may be coming up just now
constexpr std::size_t kMostAtOnce = 64;

}  // namespace

// ---- the relay's side

void RouterCore::neighbour_changed(const std::string& id, Now now) {
  if (!relays()) return;
  changed_neighbours_.insert(id);
  next_neighbours_ = earlier(next_neighbours_, now.mono + kGather);
}

void RouterCore::tell_neighbours(Link& to, const std::set<std::string>& about, Effects& out) {
  Neighbours told;
  const auto send = [&] {
    if (!told.reached.empty() || !told.gone.empty()) link_send(to, told, out);
    told = {};
  };
  for (const std::string& id : about) {
    if (id == to.peer) continue;
    const auto peer = peers_.find(id);
    const bool reached = peer != peers_.end() && peer->second.link != 0;
    if (reached) {
      told.reached.push_back(peer->second.certificate_record);
    } else {
      told.gone.push_back(id);
    }
    if (told.reached.size() >= kMostAtOnce || told.gone.size() >= kMostAtOnce) send();
  }
  send();
}

/// A new link is told of all that are reached.
void RouterCore::tell_all_neighbours(Link& to, Effects& out) {
  if (!relays()) return;
  std::set<std::string> all;
  for (const auto& [id, peer] : peers_) {
    if (peer.link != 0) all.insert(id);
  }
  tell_neighbours(to, all, out);
}

void RouterCore::tick_relay(Now now, Effects& out) {
  if (!next_neighbours_ || now.mono < *next_neighbours_) return;
  next_neighbours_.reset();
  const auto changed = std::exchange(changed_neighbours_, {});
  for (const LinkId id : up_links()) tell_neighbours(links_.at(id), changed, out);
}

/// One hop only: what a link brings to be passed on is its own peer's. What is in it is locked for its target.
void RouterCore::pass_on(Link& link, const Message& message, const Relayed& body, const RelayedFrame& inner,
                         Effects& out) {
  if (!relays()) return refuse_relayed(link, "no_relay", "for '" + inner.target + "': this node is no relay", out);
  if (body.record.signer != link.peer)
    return refuse_relayed(link, "second_hop", "signed by '" + body.record.signer + "'", out);
  const auto target = peers_.find(inner.target);
  if (target == peers_.end() || target->second.link == 0) {
    const Errc reason = target == peers_.end() ? Errc::unknown_target : Errc::peer_unreachable;
    out.count("dropped." + std::string(errc_name(reason)));
    return link_send(link, RelayRefused{inner.target, inner.count, std::string(errc_name(reason))}, out);
  }
  out.count("relayed.sent");
  Message passed = message;
  passed.source = config_.id;
  passed.target = inner.target;
  passed.id = ++message_count_;
  send_on(links_.at(target->second.link), std::move(passed), out);
}

void RouterCore::not_passed_on(const Message& message, Errc reason, Effects& out) {
  out.count("dropped." + std::string(errc_name(reason)));
  const auto body = decode<Relayed>(message.data);
  const auto inner = body ? decode<RelayedFrame>(body->record.payload.bytes) : Result<RelayedFrame>(body.error());
  if (!inner) return;
  if (body->record.signer == config_.id) return not_relayed(inner->target, inner->count, reason, out);
  const auto source = peers_.find(body->record.signer);
  const auto link = source == peers_.end() ? links_.end() : links_.find(source->second.link);
  if (link != links_.end())
    link_send(link->second, RelayRefused{inner->target, inner->count, std::string(errc_name(reason))}, out);
}

void RouterCore::send_on(Link& link, Message message, Effects& out) {
  out.add(LinkSend{link.id, std::move(message)});
}

void RouterCore::refuse_relayed(const Link& link, std::string_view reason, const std::string& text, Effects& out) {
  out.count("refused.relayed_" + std::string(reason));
  out.log(LogLevel::warning, "relayed_refused", "by " + link.peer + ": " + text);
}

// ---- everybody else's side: by whom a peer is reached

/// The link of the relay that carries this node's words to the peer; another one's if that has gone.
const Link* RouterCore::carrier_of(const Peer& peer) const {
  const auto usable = [&](const std::string& id) {
    const auto relay = peers_.find(id);
    const Link* link = relay == peers_.end() ? nullptr : find_link(relay->second.link);
    return link != nullptr && link->relay ? link : nullptr;
  };
  if (peer.relays.count(peer.carrier) != 0) {
    if (const Link* link = usable(peer.carrier)) return link;
  }
  for (const std::string& id : peer.relays) {
    if (const Link* link = usable(id)) return link;
  }
  return nullptr;
}

const Link* RouterCore::relay_of(const Peer& peer) const {
  return peer.by_relay && peer.link == 0 ? carrier_of(peer) : nullptr;
}

/// The next relay that says it reaches the peer, in turn: this one has lost what it was given.
void RouterCore::change_carrier(Peer& peer) {
  const Link* now = carrier_of(peer);
  if (now == nullptr) return;
  auto next = peer.relays.upper_bound(now->peer);
  if (next == peer.relays.end()) next = peer.relays.begin();
  peer.carrier = *next;
}

void RouterCore::on_neighbours(Link& link, const Neighbours& told, Now now, Effects& out) {
  if (!link.relay) {
    out.count("refused.not_permitted");
    return out.log(LogLevel::warning, "not_permitted", link.peer + " tells of neighbours and may not relay");
  }
  for (const SignedRecord& one : told.reached) learn_neighbour(link, one, now, out);
  for (const std::string& id : told.gone) {
    if (const auto at = peers_.find(id); at != peers_.end()) forget_relay(at->second, link.peer, out);
  }
}

void RouterCore::refuse_neighbour(const Link& relay, const Error& error, Effects& out) {
  out.count("refused.neighbour_" + std::string(errc_name(error.code)));
  out.log(LogLevel::warning, "neighbour_refused", "of " + relay.peer + ": " + error.text());
}

/// A hint that a member is there: what it is it says itself, once this node has spoken to it through the relay.
void RouterCore::learn_neighbour(Link& link, const SignedRecord& told, Now now, Effects& out) {
  Budget& checks = peers_.at(link.peer).neighbour_checks;
  if (!is_known_certificate(told) && !checks.take(now.mono)) return out.count("refused.neighbour_too_many");
  auto certificate = open_member(told, now, out);
  if (!certificate) return refuse_neighbour(link, certificate.error(), out);
  if (certificate->id == config_.id) return;
  if (Status newest = check_newest(*certificate); !newest) return refuse_neighbour(link, newest.error(), out);
  if (peers_.count(certificate->id) == 0 && peers_.size() >= kMaxPeers)
    return refuse_neighbour(link, fail(Errc::queue_full, "the routing table is full", std::string(kFullCure)), out);
  Peer& peer = make_peer(*certificate, told);
  const bool fresh = peer.relays.insert(link.peer).second;
  if (peer.link == 0 && fresh && !peer.road.proven()) peer.road.begin(now.mono + kLinksFirst);
}

/// That relay does not reach it any more, or is not reached itself.
void RouterCore::forget_relay(Peer& peer, const std::string& relay, Effects& out) {
  if (peer.relays.erase(relay) == 0 || !peer.by_relay || carrier_of(peer) != nullptr) return;
  leave_road(peer, peer.id + " was reached by " + relay, out);
}

void RouterCore::relay_lost(const Link& relay, Effects& out) {
  if (!relay.relay) return;
  for (auto& [id, peer] : peers_) forget_relay(peer, relay.peer, out);
}

std::vector<std::string> RouterCore::relayed_peers() const {
  std::vector<std::string> out;
  for (const auto& [id, peer] : peers_) {
    if (relay_of(peer) != nullptr) out.push_back(id);
  }
  return out;
}

}  // namespace trb::router
