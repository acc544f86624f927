#include "services/router/core/admission.hpp"

#include "common/base/hex.hpp"

namespace trb::router {
namespace {

constexpr std::size_t kMaxDenied = 8 * kMaxCandidates;

}  // namespace

bool Admission::admit(BytesView key, Now now, Effects& out) {
  // It may be the key of one who is revoked.
  if (node_.config().updates_lost) {
    out.count("refused.revocations_unknown");
    return false;
  }
  if (key == node_.config().own.link_key.bytes || trust_.refuse_revoked_key(key, now, out)) return false;
  // A revoked node knows that its Hello is refused; one whose certificate only ended may be brought its renewal.
  if (trust_.own_revocation() != nullptr) return false;
  if (invited_.contains(key)) return true;
  if (const auto at = noisy_.find(key); at != noisy_.end() && now.mono < at->second) {
    out.count("refused.noisy_key");
    return false;
  }
  // Members, and peers of node.json that were never met: no crowd of strangers keeps them out.
  if (!table_.is_expected(key)) return admit_stranger(key, now.mono, out);
  Peer* peer = table_.by_key(key);
  if (peer != nullptr && now.mono < peer->out_until) {
    out.count("refused.noisy_key");
    return false;
  }
  if (peer != nullptr) peer->comes_until = now.mono + node_.config().timing.handshake;
  return true;
}

bool Admission::admit_stranger(BytesView key, MonotonicTime now, Effects& out) {
  if (is_denied(key, now)) {
    out.count("refused.denied_key");
    out.log(LogLevel::warning, "denied_key", "the key " + to_hex(key) + " was refused a moment ago");
    return false;
  }
  if (candidates_.count(key) == 0 && candidates_.size() >= kMaxCandidates) {
    out.count("refused.too_many_candidates");
    out.log(LogLevel::warning, "too_many_candidates", "no room for the unknown key " + to_hex(key));
    return false;
  }
  if (candidates_.emplace(Bytes(key), now + node_.config().timing.handshake).second) out.count("candidates");
  return true;
}

bool Admission::is_denied(BytesView key, MonotonicTime now) const {
  const auto at = denied_.find(key);
  return at != denied_.end() && now < at->second;
}

void Admission::settle(BytesView key) {
  if (const auto at = candidates_.find(key); at != candidates_.end()) candidates_.erase(at);
}

void Admission::deny(BytesView key, MonotonicTime now) {
  settle(key);
  if (denied_.size() < kMaxDenied) denied_[Bytes(key)] = now + node_.config().timing.denied;
}

void Admission::invite(BytesView key) {
  settle(key);
  if (const auto at = denied_.find(key); at != denied_.end()) denied_.erase(at);
  invited_.emplace(key);
}

void Admission::withdraw(BytesView key) {
  if (const auto at = invited_.find(key); at != invited_.end()) invited_.erase(at);
}

void Admission::silence(BytesView key, MonotonicTime now) {
  noisy_[Bytes(key)] = now + node_.config().timing.denied;
}

void Admission::tick(Now now, Effects& out) {
  const auto is_over = [&](const auto& row) { return now.mono >= row.second; };
  const Keys candidates = candidates_;
  for (const auto& row : candidates) {
    if (!is_over(row)) continue;
    out.count("refused.no_hello");
    out.log(LogLevel::warning, "no_hello",
            "the unknown key " + to_hex(row.first) + " connected and said no Hello in time");
    deny(row.first, now.mono);
  }
  std::erase_if(noisy_, is_over);
  std::erase_if(denied_, is_over);
}

std::optional<MonotonicTime> Admission::next_deadline() const {
  std::optional<MonotonicTime> next;
  for (const auto& [key, until] : candidates_) next = earlier(next, until);
  return next;
}

}  // namespace trb::router
