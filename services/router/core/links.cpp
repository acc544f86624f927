#include "services/router/core/links.hpp"

#include <algorithm>
#include <utility>

namespace trb::router {
namespace {

/// Alternates between the address that the peer names and the one where it was reached: behind NAT only the second is
/// good, after a move only the first.
const std::string& address_to_dial(Peer& peer) {
  if (peer.address.empty()) return peer.good_address;
  const bool choice = !peer.good_address.empty() && peer.good_address != peer.address;
  peer.try_good = choice && !peer.try_good;
  return peer.try_good ? peer.good_address : peer.address;
}

}  // namespace

void Links::start(Now now) {
  for (Seed& seed : table_.seeds()) seed.redial.at = now.mono;
}

void Links::drop_all(const std::string& why, Now now, Effects& out) {
  std::vector<LinkId> links;
  for (const auto& [id, link] : table_.links()) links.push_back(id);
  for (const LinkId id : links) drop(id, why, true, now, out);
}

void Links::redial_all(Now now) {
  for (auto& [id, peer] : table_.change_peers()) peer.redial = {now.mono, {}, 0};
  for (Seed& seed : table_.seeds()) seed.redial = {now.mono, {}, 0};
}

void Links::redial_unlinked(Now now) {
  for (Seed& seed : table_.seeds()) seed.redial = {now.mono, {}, 0};
  for (auto& [id, peer] : table_.change_peers()) {
    if (peer.link == 0) peer.redial = {now.mono, {}, 0};
  }
}

void Links::dial(Redial& redial, const Dialled& whom, Now now, Effects& out) {
  Link link;
  link.id = node_.random();
  link.dialled = true;
  link.key = whom.key;
  link.address = whom.address;
  link.dialled_for = whom.peer;
  link.opened = now.mono;
  link.last_heard = now.mono;
  redial.at.reset();
  redial.link = link.id;
  out.add(Dial{link.id, link.address, link.key});
  table_.add(std::move(link));
}

void Links::redial_later(Redial& redial, Now now, Duration at_least) {
  const Timing& timing = node_.config().timing;
  redial.link = 0;
  redial.wait = redial.wait == Duration{} ? timing.redial_first : std::min(redial.wait * 2, timing.redial_most);
  redial.at = now.mono + std::max(redial.wait, at_least);
}

void Links::redial_soon(Peer& peer, Now now) {
  peer.redial.wait = {};
  peer.redial.at = now.mono + (node_.is_smaller_than(peer.id) ? Duration{} : node_.config().timing.yield);
}

void Links::redial_failed(const Link& gone, Now now) {
  const Duration most = node_.config().timing.redial_most;
  for (Seed& seed : table_.seeds()) {
    if (seed.redial.link != gone.id) continue;
    const bool patient = seed.hint && seed.redial.wait >= most;
    redial_later(seed.redial, now, patient ? kHintPause : Duration{});
  }
  Peer* peer = table_.find(gone.dialled_for);
  if (peer == nullptr || peer->redial.link != gone.id) return;
  const bool patient = watcher_.is_relayed(*peer) && peer->redial.wait >= most;
  redial_later(peer->redial, now, patient ? kViaPause : Duration{});
}

void Links::drop(LinkId id, const std::string& why, bool send_goodbye, Now now, Effects& out) {
  const Link* link = table_.link(id);
  if (link == nullptr) return;
  if (link->up) seals_.note_open_end(id, link->peer, out);
  if (link->up && seals_.holds(id)) out.add(ReturnHeld{id, link->peer, why, send_goodbye});
  if (send_goodbye && link->up) seals_.last_seal(id, out);
  if (send_goodbye && link->up) messages_.send(*link, Goodbye{why.substr(0, 128)}, out);
  // A node that is off is dialled for ever: the events have two names, so that its lines do not use up the limit of
  // lines for real ends.
  out.log(LogLevel::info, link->up ? "link_closed" : "dial_ended",
          (link->peer.empty() ? "unproven" : link->peer) + ": " + why);
  out.add(CloseLink{id});
  const Link gone = *link;
  table_.remove(id);
  redial_failed(gone, now);
  Peer* peer = gone.up ? table_.find(gone.peer) : nullptr;
  if (peer != nullptr && peer->link == id) lose(*peer, gone, now, out);
}

void Links::lose(Peer& peer, const Link& gone, Now now, Effects& out) {
  peer.link = 0;
  // The lease runs from the last sign of life, not from when its end was noticed.
  peer.lost = std::min(gone.last_heard, gone.confirmed);
  peer.last_heard = gone.last_heard;
  watcher_.on_link_lost(peer, gone, now, out);
  // Both may dial again; the greater id waits a little for the smaller.
  redial_later(peer.redial, now, node_.is_smaller_than(peer.id) ? Duration{} : node_.config().timing.yield);
}

void Links::on_ended(LinkId id, LinkEndReason how, Now now, Effects& out) {
  const Link* link = table_.link(id);
  if (link == nullptr) return;
  if (how != LinkEndReason::failed && how != LinkEndReason::disconnected)
    out.count("dial." + std::string(name_of(how)));
  if (!link->up) errors_.note_link(id, name_of(how), "the dial ended before a Hello was heard", now);
  drop(id, std::string(name_of(how)), false, now, out);
}

void Links::on_bad_frame(LinkId id, const Error& error, Now now, Effects& out) {
  const std::string code(errc_name(error.code));
  out.count("refused." + code);
  out.log(LogLevel::warning, "frame_refused", error.text());
  errors_.note_link(id, code, error.what, now);
  drop(id, "sent a frame that is none: " + code, true, now, out);
}

void Links::on_second_link(LinkId id, Now now, Effects& out) {
  const Link* link = table_.link(id);
  if (link == nullptr) return;
  out.count("refused.second_hello");
  out.log(LogLevel::warning, "second_hello", link->peer + " wants a second link on one connection");
  drop(id, "a second link on one connection", true, now, out);
}

void Links::on_incomplete(LinkId id, Now now, Effects& out) {
  const Link* link = table_.link(id);
  if (link == nullptr) return;
  out.count("cut.incomplete");
  const std::string why = "it sent parts of a message without end";
  out.log(LogLevel::warning, "incomplete",
          (link->peer.empty() ? link->address : link->peer) + ": " + why + "; its key stays out for a while");
  errors_.note_link(id, "incomplete", why, now);
  const Bytes key = link->key;
  drop(id, why, false, now, out);
  keep_out(key, now);
}

void Links::keep_out(BytesView key, Now now) {
  const MonotonicTime until = now.mono + node_.config().timing.denied;
  if (Peer* peer = table_.by_key(key)) peer->out_until = until;
  for (Seed& seed : table_.seeds()) {
    if (seed.key == key && seed.redial.at) seed.redial.at = until;
  }
}

void Links::break_seal(LinkId id, const std::string& peer, SealFault fault, Now now, Effects& out) {
  const Link* link = table_.link(id);
  const std::string reason(name_of(fault));
  std::string text = "link " + std::to_string(id) + " of " + peer + ", ";
  // The check of a signature may take longer than the link lasts.
  text += link == nullptr ? "which has ended" : "after sequence " + std::to_string(link->heard);
  text += ": " + reason;
  out.count("refused.seal_" + reason);
  // One event per reason: many lines of one kind do not use up the limit of another.
  out.log(LogLevel::error, "seal_alarm_" + reason, text + "; what it carried since its last seal is not proven");
  errors_.note_link(id, errc_name(Errc::seal_broken), text, now);
  drop(id, "seal_broken: " + reason, true, now, out);
}

void Links::on_name_found(LinkId id, const std::string& address) {
  if (Link* link = table_.link(id)) link->address = address;
}

void Links::on_name_unknown(LinkId id, const std::string& why, Now now, Effects& out) {
  if (table_.link(id) == nullptr) return;
  out.count("dial.no_name");
  if (!why.empty()) errors_.note_link(id, "no_name", why, now);
  drop(id, why.empty() ? "its name is asked for" : why, false, now, out);
}

bool Links::receive(Link& link, const HeaderView& header, Now now, Effects& out) {
  if (header.sequence != link.heard + 1 && link.up) {
    out.count("refused.sequence");
    const std::string why = "sequence " + std::to_string(header.sequence) + " after " + std::to_string(link.heard);
    out.log(LogLevel::warning, "sequence_gap", link.peer + ": " + why);
    drop(link.id, why, true, now, out);
    return false;
  }
  link.heard = header.sequence;
  link.last_heard = now.mono;
  return true;
}

void Links::on_keep_alive(Link& link, const KeepAlive& body, Now now) {
  const auto first = std::ranges::upper_bound(link.unconfirmed, body.heard);
  if (first == link.unconfirmed.begin()) return;
  link.unconfirmed.erase(link.unconfirmed.begin(), first);
  link.confirmed = now.mono;
}

void Links::set_address(Peer& peer, const std::string& address, Now now, Effects& out) {
  if (peer.address == address) return;
  peer.address = address;
  peer.good_address.clear();
  if (peer.redial.link != 0) drop(peer.redial.link, "its address has changed", false, now, out);
}

void Links::expire(Peer& peer, const std::string& reason, Effects& out) {
  // One that was silent already may be revoked later.
  if (!peer.expired) out.count("peer_expired");
  peer.expired = true;
  out.log(LogLevel::warning, "peer_expired", peer.id + ": " + reason);
  bus_.notify(PeerExpired{peer.id, reason}, out);
}

// ---- time

std::optional<MonotonicTime> Links::next_deadline() const {
  std::optional<MonotonicTime> next = table_.deadlines().earliest();
  for (const Seed& seed : table_.seeds()) next = earlier(next, seed.redial.at);
  return next;
}

void Links::tick(bool may_dial, Now now, Effects& out) {
  tick_links(now, out);
  tick_peers(may_dial, now, out);
  for (Seed& seed : table_.seeds()) {
    if (seed.redial.at && now.mono >= *seed.redial.at) dial_seed(seed, may_dial, now, out);
  }
}

std::optional<Links::Lapse> Links::lapse_of(const Link& link, Now now) const {
  const Timing& timing = node_.config().timing;
  if (!link.up) {
    if (now.mono < link.opened + timing.handshake) return std::nullopt;
    return Lapse{link.id, "no_hello", "no Hello in time"};
  }
  const Peer& peer = *std::as_const(table_).find(link.peer);
  if (node_.checked_utc(now.utc).ns >= peer.certificate.not_after)
    return Lapse{link.id, "cert_expired", "its certificate has ended"};
  if (now.mono >= link.last_heard + timing.lease) return Lapse{link.id, "not_heard", std::string(kUnheard)};
  if (now.mono < link.confirmed + timing.lease) return std::nullopt;
  // Cut both ways, the echo ends a little before the messages do; cut one way, TCP soon stalls in the other direction
  // too, but beacons still arrive.
  const bool still_heard = now.mono - std::max(link.last_heard, peer.last_beacon) < timing.lease * 3 / 5;
  // The Goodbye's text shows the other side whether it was a one-way cut.
  if (still_heard) return Lapse{link.id, "one_way", "not heard by the other side for a lease"};
  return Lapse{link.id, "not_heard", std::string(kUnheard)};
}

void Links::keep_alive(Link& link, Now now, Effects& out) {
  link.next_keep_alive = now.mono + node_.config().timing.keep_alive;
  // With a keep-alive everything before it is sealed.
  seals_.seal_now(link.id, out);
  messages_.send(link, KeepAlive{link.heard}, out);
  // It gets this sequence number or, behind frames already on their way out, a higher one.
  link.unconfirmed.push_back(seals_.next_sequence(link.id));
}

void Links::tick_links(Now now, Effects& out) {
  std::vector<Lapse> lapsed;
  for (Link* link : table_.deadlines().due_links(now.mono, node_.checked_utc(now.utc))) {
    table_.touch(*link);
    if (auto lapse = lapse_of(*link, now)) {
      lapsed.push_back(std::move(*lapse));
    } else if (link->up && now.mono >= link->next_keep_alive) {
      keep_alive(*link, now, out);
    }
  }
  for (const auto& [id, code, why] : lapsed) {
    if (code == "cert_expired") out.count("refused.cert_expired");
    errors_.note_link(id, code, why, now);
    drop(id, why, true, now, out);
  }
}

void Links::tick_peers(bool may_dial, Now now, Effects& out) {
  for (Peer* peer : table_.deadlines().due_peers(now.mono)) {
    table_.touch(*peer);
    if (peer->lost && !peer->expired && now.mono >= *peer->lost + node_.config().timing.lease)
      expire(*peer, "lease ended", out);
    if (peer->redial.at && now.mono >= *peer->redial.at) dial_peer(*peer, may_dial, now, out);
  }
}

void Links::dial_peer(Peer& peer, bool may_dial, Now now, Effects& out) {
  const Bytes& key = peer.certificate.link_key.bytes;
  if (!may_dial) {
    peer.redial.at = now.mono + node_.config().timing.redial_most;
  } else if (now.mono < peer.out_until) {
    peer.redial.at = peer.out_until;
  } else if (now.mono < peer.comes_until || table_.is_dialling(key)) {
    // After an outage both sides dial: two handshakes for one link, where the second could wait for the end of the
    // first.
    peer.redial.at = now.mono + node_.config().timing.redial_first;
  } else if (const std::string& address = address_to_dial(peer); address.empty()) {
    peer.redial.at.reset();  // until an address comes: by a beacon, a relay, or its own link
  } else {
    dial(peer.redial, {address, key, peer.id}, now, out);
  }
}

void Links::dial_seed(Seed& seed, bool may_dial, Now now, Effects& out) {
  const Peer* peer = table_.find(seed.peer);
  if (seed.hint && peer != nullptr && peer->met) {
    seed.redial.at.reset();
  } else if (!may_dial || trust_.is_revoked_key(seed.key) || (peer != nullptr && peer->link != 0) ||
             table_.is_dialling(seed.key)) {
    // The link exists, or is being dialled at another address; look again later, in case that address is lost.
    seed.redial.at = now.mono + node_.config().timing.redial_most;
  } else if (peer != nullptr && now.mono < peer->out_until) {
    seed.redial.at = peer->out_until;
  } else {
    dial(seed.redial, {seed.address, seed.key, ""}, now, out);
  }
}

}  // namespace trb::router
