// Who belongs to the fleet now: dates, revocations, the newest certificate of each; this node's own membership too.
#include <algorithm>

#include "common/base/hex.hpp"
#include "common/security/revocations.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {

UtcTime RouterCore::checked_utc(UtcTime utc) const {
  // A clock before a time that has certainly passed is wrong: that time is the lower bound.
  return std::max({utc, UtcTime{config_.own.not_before}, clock_.bound()});
}

Result<Certificate> RouterCore::open_known(const SignedRecord& record) const {
  // Every beacon, Hello and relay shows it again: the signature of the very record that a peer is known by was checked.
  const auto shown = decode<Certificate>(record.payload.bytes);
  const auto peer = shown ? peers_.find(shown->id) : peers_.end();
  if (peer != peers_.end() && peer->second.certificate_record == record) return peer->second.certificate;
  return open_certificate_any_time(record, config_.authority);
}

Result<Certificate> RouterCore::open_member(const SignedRecord& record, Now now, Effects& out) {
  auto certificate = open_known(record);
  if (!certificate) return certificate;
  if (const Revocation* entry = find_revocation(news_.list, *certificate)) {
    remember_revoked(*certificate);
    return fail(Errc::cert_revoked,
                "certificate of '" + certificate->id + "' (serial " + std::to_string(certificate->serial) +
                    ") is revoked by list " + std::to_string(news_.list.number) + ": " + entry->reason,
                "if it shall be a member again: new keys, trb fleet request and trb fleet sign");
  }
  // This clock is known to be behind: what the authority has signed tells more of the time than it does.
  const bool verified = checked_utc(now.utc) == now.utc;
  if (!verified) raise_utc_bound({certificate->not_before}, out);
  if (Status dates = check_dates(*certificate, checked_utc(now.utc)); !dates) return dates.error();
  return certificate;
}

Status RouterCore::check_newest(const Certificate& certificate) const {
  std::uint64_t newest = certificate.id == config_.id ? config_.own.serial : 0;
  if (const auto peer = peers_.find(certificate.id); peer != peers_.end()) newest = peer->second.certificate.serial;
  if (const auto at = news_.renewed.find(certificate.id); at != news_.renewed.end()) {
    if (const auto renewed = decode<Certificate>(at->second.payload.bytes)) newest = std::max(newest, renewed->serial);
  }
  if (certificate.serial >= newest) return Done{};
  return fail(Errc::downgraded,
              "an older certificate of '" + certificate.id + "': serial " + std::to_string(certificate.serial) + ", " +
                  std::to_string(newest) + " is known",
              "use the one that was signed last");
}

void RouterCore::remember_revoked(const Certificate& certificate) {
  if (news_.revoked_keys.size() < kMaxPeers) news_.revoked_keys[certificate.link_key.bytes] = certificate;
}

bool RouterCore::refuse_revoked_key(BytesView key, MonotonicTime now, Effects& out) {
  const auto at = news_.revoked_keys.find(key);
  if (at == news_.revoked_keys.end()) return false;
  const Revocation* entry = find_revocation(news_.list, at->second);
  troubles_.note(at->second.id, "", "cert_revoked",
                 "its key has knocked since: " + (entry == nullptr ? std::string("revoked") : entry->reason), now);
  out.count("refused.cert_revoked");
  out.log(LogLevel::warning, "revoked_key", "the revoked key of '" + at->second.id + "' knocked: " + to_hex(key));
  return true;
}

void RouterCore::apply_revocations(Now now, Effects& out) {
  std::erase_if(news_.revoked_keys,
                [&](const auto& row) { return find_revocation(news_.list, row.second) == nullptr; });
  std::vector<std::string> over;
  for (const auto& [id, peer] : peers_) {
    if (find_revocation(news_.list, peer.certificate) != nullptr) over.push_back(id);
  }
  for (const std::string& id : over) put_out(id, now, out);
  std::erase_if(news_.renewed, [&](const auto& row) {
    const auto certificate = decode<Certificate>(row.second.payload.bytes);
    return !certificate || find_revocation(news_.list, *certificate) != nullptr;
  });
}

void RouterCore::put_out(const std::string& id, Now now, Effects& out) {
  Peer& peer = peers_.at(id);
  const Revocation& entry = *find_revocation(news_.list, peer.certificate);
  const Bytes key = peer.certificate.link_key.bytes;
  remember_revoked(peer.certificate);
  candidates_.erase(key);
  std::vector<LinkId> links;
  for (const auto& [link, row] : links_) {
    if (row.key == key || row.peer == id) links.push_back(link);
  }
  if (peer.link != 0) out.count("refused.cert_revoked");
  for (const LinkId link : links) drop_link(link, "cert_revoked: " + entry.reason, true, now, out);
  out.log(LogLevel::warning, "peer_revoked", id + " (serial " + std::to_string(entry.serial) + "): " + entry.reason);
  if (peer.met && !peer.expired) expire(peer, "cert_revoked: " + entry.reason, out);
  for (Seed& seed : seeds_) {
    if (seed.peer == id) seed.peer.clear();
  }
  troubles_.note(id, "", "cert_revoked", "by list " + std::to_string(news_.list.number) + ": " + entry.reason,
                 now.mono);
  peers_by_key_.erase(key);
  peers_.erase(id);
}

std::string RouterCore::own_trouble(Now now) const {
  if (const Revocation* entry = find_revocation(news_.list, config_.own)) {
    return "this node's certificate is revoked: " + entry->reason;
  }
  if (checked_utc(now.utc).ns >= config_.own.not_after) {
    return "this node's certificate ended " + to_iso8601({config_.own.not_after});
  }
  return "";
}

std::string RouterCore::own_note(Now now) const {
  if (!waits_for_.empty()) return waits_for_;
  if (std::string trouble = own_trouble(now); !trouble.empty()) return trouble;
  const Duration left{config_.own.not_after - checked_utc(now.utc).ns};
  if (left > kWarnBefore) return "";
  const auto days = std::chrono::duration_cast<std::chrono::hours>(left).count() / 24;
  return "certificate ends " + to_iso8601({config_.own.not_after}) + ", in " + std::to_string(days) +
         " days: trb fleet renew FLEET_DIR " + config_.id;
}

void RouterCore::check_own(Now now, Effects& out) {
  const std::string trouble = own_trouble(now);
  // Nothing else may be due while it is mute, and it is its clock alone that may end that.
  if (!trouble.empty()) next_own_check_ = now.mono + config_.timing.redial_most;
  if (trouble.empty() == !news_.muted) return warn_of_end(now, out);
  if (!trouble.empty()) return mute(trouble, now, out);
  news_.muted = false;
  next_own_check_.reset();
  troubles_.recovered(config_.id, "");
  out.log(LogLevel::info, "member_again", "serial " + std::to_string(config_.own.serial));
  if (config_.beacon && !config_.address.empty()) next_beacon_ = now.mono;
  for (Seed& seed : seeds_) seed.redial = {now.mono, {}, 0};
  for (auto& [id, peer] : peers_) {
    if (peer.link == 0) peer.redial = {now.mono, {}, 0};
  }
}

void RouterCore::mute(const std::string& why, Now now, Effects& out) {
  news_.muted = true;
  next_beacon_.reset();
  out.count("own_certificate_over");
  const bool revoked = find_revocation(news_.list, config_.own) != nullptr;
  troubles_.note(config_.id, "", revoked ? "own.cert_revoked" : "own.cert_expired", why, now.mono);
  out.log(
      LogLevel::error, "own_certificate_over",
      why + "; no other node takes this one. If it shall be a member: trb fleet renew, or new keys and trb fleet sign");
  for (const LinkId id : up_links()) drop_link(id, why, true, now, out);
}

void RouterCore::warn_of_end(Now now, Effects& out) {
  const UtcTime utc = checked_utc(now.utc);
  // Also if it was said while the clock was far ahead.
  const bool said = news_.warned && utc < *news_.warned + kWarnEvery && utc > *news_.warned - kWarnEvery;
  if (news_.muted || said) return;
  const std::string note = own_note(now);
  if (note.empty()) return;
  news_.warned = utc;
  out.log(LogLevel::warning, "certificate_ends", note);
}

void RouterCore::raise_utc_bound(UtcTime utc, Effects& out) {
  if (utc <= checked_utc({})) return;
  clock_.raise(utc);
  out.add(StoreUtc{utc});
}

void RouterCore::note_time(Now now, Effects& out) {
  clock_.watch(now);
  if (checked_utc(now.utc) != now.utc || now.utc.ns >= config_.own.not_after) return;
  std::vector<std::int64_t> peers;
  for (const auto& [id, link] : links_) {
    if (link.up && link.utc_at_zero) peers.push_back(*link.utc_at_zero);
  }
  if (const auto utc = clock_.to_store(now, peers)) out.add(StoreUtc{*utc});
}

}  // namespace trb::router
