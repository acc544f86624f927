// Addresses that change: this node's own, its peers', and those that were good before the last end.
#include <algorithm>

#include "common/base/hex.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {

void RouterCore::set_address(const std::string& address, const std::string& why, Now now, Effects& out) {
  waits_for_ = address.empty() ? why : "";
  if (address == config_.address) return;
  out.count("address_changed");
  config_.address = address;
  next_beacon_.reset();
  // Nothing comes or goes by the old one any more, and nobody would tell.
  std::vector<LinkId> links;
  for (const auto& [id, link] : links_) links.push_back(id);
  for (const LinkId id : links) drop_link(id, "this node's address has changed", true, now, out);
  if (address.empty()) return;
  // The peers do not know yet where it is now, so both ids dial at once; a beacon tells the others.
  for (auto& [id, peer] : peers_) peer.redial = {now.mono, {}, 0};
  for (Seed& seed : seeds_) seed.redial = {now.mono, {}, 0};
  if (!config_.beacon) return;
  early_beacons_ = 3;
  next_beacon_ = now.mono;
}

bool RouterCore::is_expected(BytesView key) const {
  return peers_by_key_.count(key) != 0 ||
         std::any_of(seeds_.begin(), seeds_.end(), [&](const Seed& seed) { return seed.key == key; });
}

/// Where it says that it is, and where it was reached, one after the other: behind a translator only the second is
/// good, after a move only the first.
const std::string& RouterCore::address_to_dial(Peer& peer) {
  if (peer.address.empty()) return peer.good_address;
  const bool choice = !peer.good_address.empty() && peer.good_address != peer.address;
  peer.try_good = choice && !peer.try_good;
  return peer.try_good ? peer.good_address : peer.address;
}

void RouterCore::on_name_found(LinkId id, const std::string& address) {
  if (const auto at = links_.find(id); at != links_.end()) at->second.address = address;
}

void RouterCore::on_name_unknown(LinkId id, const std::string& why, Now now, Effects& out) {
  if (links_.count(id) == 0) return;
  out.count("dial.no_name");
  if (!why.empty()) note_trouble(id, "no_name", why, now);
  drop_link(id, why.empty() ? "its name is asked for" : why, false, now, out);
}

void RouterCore::set_peer_address(Peer& peer, const std::string& address, Now now, Effects& out) {
  if (peer.address == address) return;
  peer.address = address;
  peer.good_address.clear();
  if (peer.redial.link != 0) drop_link(peer.redial.link, "its address has changed", false, now, out);
}

void RouterCore::tick_known(Now now, Effects& out) {
  if (!next_store_ || now.mono < *next_store_) return;
  next_store_.reset();
  std::string text;
  for (const auto& [id, peer] : peers_) {
    const std::string& address = peer.good_address.empty() ? peer.address : peer.good_address;
    if (!peer.met || address.empty()) continue;
    text += address + " " + to_hex(peer.certificate.link_key.bytes) + "\n";
  }
  out.add(StorePeers{std::move(text)});
}

}  // namespace trb::router
