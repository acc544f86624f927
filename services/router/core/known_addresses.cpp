#include "services/router/core/known_addresses.hpp"

#include "common/base/hex.hpp"

namespace trb::router {

void KnownAddresses::tick(Now now, Effects& out) {
  if (!next_ || now.mono < *next_) return;
  next_.reset();
  std::string text;
  for (const auto& [id, peer] : table_.peers()) {
    const std::string& address = peer.good_address.empty() ? peer.address : peer.good_address;
    if (!peer.met || address.empty()) continue;
    text += address + " " + to_hex(peer.certificate.link_key.bytes) + "\n";
  }
  out.add(StorePeers{std::move(text)});
}

}  // namespace trb::router
