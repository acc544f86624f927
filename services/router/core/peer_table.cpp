#include "services/router/core/peer_table.hpp"

#include <algorithm>

#include "common/base/address.hpp"

namespace trb::router {

PeerTable::PeerTable(const RouterConfig& config) : deadlines_(config.timing) {
  const Bytes& own = config.own.link_key.bytes;
  for (const SeedAddress& seed : config.seeds) {
    if (seed.key != own) seeds_.push_back({seed.address, seed.key, {}, {}});
  }
  for (const SeedAddress& hint : config.known) {
    if (!is_numeric_endpoint(hint.address)) continue;  // as an earlier release stored it
    if (hint.key != own && !is_expected(hint.key)) seeds_.push_back({hint.address, hint.key, {}, {}, true});
  }
}

LinkDeadlines& PeerTable::deadlines() {
  deadlines_.refresh(links_, by_id_);
  return deadlines_;
}

PeerTable::Peers& PeerTable::change_peers() {
  for (auto& [id, peer] : peers_) deadlines_.touch(peer);
  return peers_;
}

Peer* PeerTable::find(std::string_view id) {
  Peer* peer = by_id_.find(id);
  if (peer != nullptr) deadlines_.touch(*peer);
  return peer;
}

const Peer* PeerTable::find(std::string_view id) const {
  return by_id_.find(id);
}

Peer* PeerTable::by_key(BytesView key) {
  const auto at = by_key_.find(key);
  return at == by_key_.end() ? nullptr : find(at->second);
}

bool PeerTable::is_expected(BytesView key) const {
  return by_key_.count(key) != 0 ||
         std::any_of(seeds_.begin(), seeds_.end(), [&](const Seed& seed) { return seed.key == key; });
}

void PeerTable::forget_hints(BytesView key) {
  std::erase_if(seeds_, [&](const Seed& seed) { return seed.hint && seed.key == key; });
}

std::size_t PeerTable::awaited() const {
  const auto is_met = [&](const Seed& seed) {
    const Peer* peer = seed.peer.empty() ? nullptr : find(seed.peer);
    return peer != nullptr && peer->met;
  };
  return seeds_.size() - static_cast<std::size_t>(std::ranges::count_if(seeds_, is_met));
}

bool PeerTable::has_room_for(std::string_view id) const {
  return peers_.size() < kMaxPeers || peers_.count(id) != 0;
}

Peer& PeerTable::learn(const Certificate& certificate, const SignedRecord& record) {
  const auto row = peers_.try_emplace(certificate.id).first;
  Peer& peer = row->second;
  by_id_.set(row->first, peer);
  deadlines_.touch(peer);
  if (peer.certificate.link_key != certificate.link_key) by_key_.erase(peer.certificate.link_key.bytes);
  const bool other =
      peer.certificate.identity_key != certificate.identity_key || peer.certificate.link_key != certificate.link_key;
  if (other) {
    peer.number = ++last_number_;
    peer.beacon_boot = peer.beacon_count = 0;
  }
  peer.id = certificate.id;
  peer.certificate = certificate;
  peer.certificate_record = record;
  by_key_[certificate.link_key.bytes] = certificate.id;
  for (Seed& seed : seeds_) {
    if (seed.key == certificate.link_key.bytes) seed.peer = certificate.id;
  }
  return peer;
}

void PeerTable::forget(const std::string& id) {
  const auto at = peers_.find(id);
  if (at == peers_.end()) return;
  for (Seed& seed : seeds_) {
    if (seed.peer == id) seed.peer.clear();
  }
  by_key_.erase(at->second.certificate.link_key.bytes);
  deadlines_.forget(at->second);
  by_id_.erase(at->first);
  peers_.erase(at);
  ++forgotten_;
}

Link* PeerTable::link(LinkId id) {
  Link* link = by_link_.find(id);
  if (link != nullptr) deadlines_.touch(*link);
  return link;
}

const Link* PeerTable::link(LinkId id) const {
  return by_link_.find(id);
}

Link& PeerTable::add(Link link) {
  const LinkId id = link.id;
  links_by_key_.emplace(link.key, id);
  Link& row = links_.emplace(id, std::move(link)).first->second;
  by_link_.set(id, row);
  deadlines_.touch(row);
  return row;
}

void PeerTable::remove(LinkId id) {
  const auto at = links_.find(id);
  if (at == links_.end()) return;
  links_by_key_.erase({at->second.key, id});
  deadlines_.forget(at->second);
  by_link_.erase(id);
  links_.erase(at);
  ++removed_;
}

std::vector<LinkId> PeerTable::links_of(BytesView key) const {
  std::vector<LinkId> out;
  for (auto at = links_by_key_.lower_bound({Bytes(key), 0}); at != links_by_key_.end() && at->first == key; ++at)
    out.push_back(at->second);
  return out;
}

Link* PeerTable::linked_by_key(BytesView key) {
  const Peer* peer = by_key(key);
  return peer == nullptr ? nullptr : link(peer->link);
}

std::vector<LinkId> PeerTable::up_links() const {
  std::vector<LinkId> out;
  for (const auto& [id, peer] : peers_) {
    if (peer.link != 0) out.push_back(peer.link);
  }
  return out;
}

bool PeerTable::is_dialling(BytesView key) const {
  return std::ranges::any_of(links_of(key), [&](LinkId id) {
    const Link& one = *link(id);
    return one.dialled && !one.up;
  });
}

}  // namespace trb::router
