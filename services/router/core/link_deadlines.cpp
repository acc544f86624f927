#include "services/router/core/link_deadlines.hpp"

#include <algorithm>

namespace trb::router {

void LinkDeadlines::touch(Link& link) {
  if (link.due.touched) return;
  link.due.touched = true;
  touched_links_.push_back(&link);
}

void LinkDeadlines::touch(Peer& peer) {
  if (peer.due.touched) return;
  peer.due.touched = true;
  touched_peers_.push_back(&peer);
}

void LinkDeadlines::forget(Link& link) {
  links_.set(&link, link.due.at, std::nullopt);
  ends_.set(&link, link.due.ends, std::nullopt);
  if (link.due.touched) std::erase(touched_links_, &link);
}

void LinkDeadlines::forget(Peer& peer) {
  peers_.set(&peer, peer.due.at, std::nullopt);
  if (peer.due.touched) std::erase(touched_peers_, &peer);
}

MonotonicTime LinkDeadlines::due(const Link& link) const {
  if (!link.up) return link.opened + timing_.handshake;
  return std::min(link.next_keep_alive, std::min(link.last_heard, link.confirmed) + timing_.lease);
}

std::optional<MonotonicTime> LinkDeadlines::due(const Peer& peer) const {
  if (peer.link != 0) return std::nullopt;
  const bool leased = peer.lost && !peer.expired;
  return leased ? earlier(peer.redial.at, *peer.lost + timing_.lease) : peer.redial.at;
}

void LinkDeadlines::refresh(std::map<LinkId, Link>& links, const LookupTable<std::string_view, Peer>& peers) {
  renew(links);
  for (Peer* peer : touched_peers_) {
    peer->due.touched = false;
    peers_.set(peer, peer->due.at, due(*peer));
  }
  touched_peers_.clear();
  for (Link* link : touched_links_) {
    link->due.touched = false;
    links_.set(link, link->due.at, due(*link));
    if (link->up == link->due.ends.has_value()) continue;  // renew() has moved a renewed one
    const Peer* peer = link->up ? peers.find(link->peer) : nullptr;
    ends_.set(link, link->due.ends,
              peer == nullptr ? std::nullopt : std::optional(UtcTime{peer->certificate.not_after}));
  }
  touched_links_.clear();
}

/// A renewed certificate moves the end of its peer's links. Those of a peer that is new have been touched as they rose.
void LinkDeadlines::renew(std::map<LinkId, Link>& links) {
  for (Peer* peer : touched_peers_) {
    const UtcTime end{peer->certificate.not_after};
    if (std::exchange(peer->due.ends, end).value_or(end) == end) continue;
    for (auto& [id, link] : links) {
      if (link.peer == peer->id && link.due.ends) ends_.set(&link, link.due.ends, end);
    }
  }
}

std::vector<Link*> LinkDeadlines::due_links(MonotonicTime now, UtcTime utc) const {
  std::vector<Link*> out = links_.due(now);
  const std::vector<Link*> ended = ends_.due(utc);
  out.insert(out.end(), ended.begin(), ended.end());
  std::ranges::sort(out, {}, &Link::id);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<Peer*> LinkDeadlines::due_peers(MonotonicTime now) const {
  std::vector<Peer*> out = peers_.due(now);
  std::ranges::sort(out, {}, &Peer::id);
  return out;
}

}  // namespace trb::router
