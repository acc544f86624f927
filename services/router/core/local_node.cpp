#include "services/router/core/local_node.hpp"

#include <algorithm>

namespace trb::router {

void LocalNode::renew(const SignedRecord& record, const Certificate& certificate) {
  config_.certificate = record;
  config_.own = certificate;
}

bool LocalNode::move_to(const std::string& address, const std::string& why) {
  waits_for_ = address.empty() ? why : "";
  if (address == config_.address) return false;
  config_.address = address;
  return true;
}

UtcTime LocalNode::checked_utc(UtcTime utc) const {
  return std::max({utc, UtcTime{config_.own.not_before}, clock_.bound()});
}

void LocalNode::raise_utc_bound(UtcTime utc, Effects& out) {
  if (utc <= checked_utc({})) return;
  clock_.raise(utc);
  out.add(StoreUtc{utc});
}

void LocalNode::note_time(Now now, const PeerClocks& peers, Effects& out) {
  clock_.watch(now);
  if (!knows_the_time(now) || now.utc.ns >= config_.own.not_after) return;
  if (const auto utc = clock_.to_store(now, peers)) out.add(StoreUtc{*utc});
}

}  // namespace trb::router
