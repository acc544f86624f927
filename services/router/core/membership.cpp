#include "services/router/core/membership.hpp"

#include <vector>

namespace trb::router {

void Membership::apply_revocations(Now now, Effects& out) {
  trust_.drop_revoked();
  std::vector<std::string> over;
  for (const auto& [id, peer] : table_.peers()) {
    if (trust_.find_revoked(peer.certificate) != nullptr) over.push_back(id);
  }
  for (const std::string& id : over) put_out(id, now, out);
}

void Membership::put_out(const std::string& id, Now now, Effects& out) {
  Peer& peer = *table_.find(id);
  const Revocation& entry = *trust_.find_revoked(peer.certificate);
  const Bytes key = peer.certificate.link_key.bytes;
  trust_.remember_revoked(peer.certificate);
  admission_.settle(key);
  std::vector<LinkId> links;
  for (const auto& [link, row] : table_.links()) {
    if (row.peer == id || (row.key == key && row.peer.empty())) links.push_back(link);
  }
  if (peer.link != 0) out.count("refused.cert_revoked");
  for (const LinkId link : links) links_.drop(link, "cert_revoked: " + entry.reason, true, now, out);
  out.log(LogLevel::warning, "peer_revoked", id + " (serial " + std::to_string(entry.serial) + "): " + entry.reason);
  // Also of one that was silent before: who waits for it need not wait any longer.
  if (peer.met) links_.expire(peer, "cert_revoked: " + entry.reason, out);
  errors_.note(id, "", "cert_revoked", "by list " + std::to_string(trust_.list_number()) + ": " + entry.reason, now);
  table_.forget(id);
}

void Membership::on_relay_right(const std::string& id, Now now, Effects& out) {
  const std::string why = "the right of '" + id + "' to relay has changed";
  if (id == node_.id()) return links_.drop_all(why, now, out);
  const Peer* peer = table_.find(id);
  if (peer != nullptr && peer->link != 0) links_.drop(peer->link, why, true, now, out);
}

std::string Membership::why_over(Now now) const {
  if (const auto& lost = node_.config().updates_lost)
    return "who is revoked is not known, so no other node is let in (trb doctor has the cure): " + lost->what;
  if (const Revocation* entry = trust_.own_revocation()) return "this node's certificate is revoked: " + entry->reason;
  const std::int64_t end = node_.config().own.not_after;
  return node_.checked_utc(now.utc).ns >= end ? "this node's certificate ended " + to_iso8601({end}) : "";
}

std::string Membership::note(Now now) const {
  if (!node_.waits_for().empty()) return node_.waits_for();
  if (std::string why = why_over(now); !why.empty()) return why;
  const std::int64_t end = node_.config().own.not_after;
  const Duration left{end - node_.checked_utc(now.utc).ns};
  if (left > kWarnBefore) return "";
  const auto days = std::chrono::duration_cast<std::chrono::hours>(left).count() / 24;
  return "certificate ends " + to_iso8601({end}) + ", in " + std::to_string(days) +
         " days: trb fleet renew FLEET_DIR " + node_.id();
}

void Membership::check_own(Now now, Effects& out) {
  const std::string why = why_over(now);
  // Nothing else may be due while it is muted, and only its clock may end that.
  if (!why.empty()) next_check_ = now.mono + node_.config().timing.redial_most;
  if (why.empty() == !muted_) return warn_of_end(now, out);
  if (why.empty()) return unmute(now, out);
  mute(why, now, out);
}

void Membership::unmute(Now now, Effects& out) {
  muted_ = false;
  next_check_.reset();
  errors_.recovered(node_.id(), "");
  out.log(LogLevel::info, "member_again", "serial " + std::to_string(node_.config().own.serial));
  beacons_.begin(now);
  links_.redial_unlinked(now);
}

void Membership::mute(const std::string& why, Now now, Effects& out) {
  muted_ = true;
  beacons_.stop();
  if (node_.config().updates_lost) {
    // It is the first thing that a router learns: it has no links.
    errors_.note(node_.id(), "", "own.revocations_unknown", why, now);
    return out.log(LogLevel::error, "revocations_unknown", why + "; " + node_.config().updates_lost->hint);
  }
  out.count("own_certificate_over");
  const bool revoked = trust_.own_revocation() != nullptr;
  errors_.note(node_.id(), "", revoked ? "own.cert_revoked" : "own.cert_expired", why, now);
  out.log(
      LogLevel::error, "own_certificate_over",
      why + "; no other node takes this one. If it shall be a member: trb fleet renew, or new keys and trb fleet sign");
  for (const LinkId id : table_.up_links()) links_.drop(id, why, true, now, out);
}

void Membership::warn_of_end(Now now, Effects& out) {
  const UtcTime utc = node_.checked_utc(now.utc);
  // Also if the warning came while the clock was far ahead.
  const bool said = warned_ && utc < *warned_ + kWarnEvery && utc > *warned_ - kWarnEvery;
  if (muted_ || said) return;
  const std::string text = note(now);
  if (text.empty()) return;
  warned_ = utc;
  out.log(LogLevel::warning, "certificate_ends", text);
}

void Membership::note_time(Now now, Effects& out) {
  const auto clocks = [this] {
    std::vector<std::int64_t> peers;
    for (const auto& [id, link] : table_.links()) {
      if (link.up && link.utc_at_zero) peers.push_back(*link.utc_at_zero);
    }
    return peers;
  };
  node_.note_time(now, clocks, out);
}

}  // namespace trb::router
