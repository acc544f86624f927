#include "services/cloud-gateway/core/live/idempotency.hpp"

#include <algorithm>

namespace trb::gateway {
namespace {

bool is_key(const std::string& key) {
  return !key.empty() && key.size() <= Idempotency::kMaxKey &&
         std::all_of(key.begin(), key.end(), [](char c) { return c > ' ' && c < '\x7f'; });
}

/// What an answer takes of kMaxLong.
std::size_t long_size(const std::optional<StoredAnswer>& answer) {
  return answer && answer->body.size() > Idempotency::kShortAnswer ? answer->body.size() : 0;
}

}  // namespace

void Idempotency::replace(const std::vector<StoredRequest>& requests) {
  requests_.clear();
  by_user_.clear();
  answered_.clear();
  long_bytes_ = 0;
  for (const StoredRequest& one : requests) put(one);
}

void Idempotency::put(const StoredRequest& request) {
  const RequestKey key = request.key;
  if (request.answer) answered_.insert({request.since, key});
  if (const StoredRequest* before = find(key)) long_bytes_ -= long_size(before->answer);
  long_bytes_ += long_size(request.answer);
  if (requests_.insert_or_assign(key, Known{request, !request.answer}).second) ++by_user_[key.user];
}

const StoredRequest* Idempotency::find(const RequestKey& key) const {
  const auto at = requests_.find(key);
  return at == requests_.end() ? nullptr : &at->second.stored;
}

Status Idempotency::check(const RequestKey& key, const std::string& effect) const {
  if (effect.size() > kMaxEffect) return fail(Errc::too_large, "effect: " + std::to_string(effect.size()) + " bytes");
  const auto known = by_user_.find(key.user);
  const std::size_t mine = known == by_user_.end() ? 0 : known->second;
  const bool too_many = mine >= kMaxOfUser;
  if (too_many || (requests_.size() >= kMaxInAll && mine >= kAlwaysOfUser)) {
    return fail(Errc::queue_full,
                too_many ? "Idempotency-Key: " + std::to_string(kMaxOfUser) + " of this user are kept"
                         : "Idempotency-Key: " + std::to_string(kMaxInAll) + " are kept",
                "each is kept for 24 h: try again later");
  }
  return Done{};
}

Result<Idempotency::Begun> Idempotency::begin(const RequestKey& key, const Bytes& digest, std::string effect,
                                              UtcTime now) {
  if (!is_key(key.key)) {
    return fail(Errc::bad_value, "Idempotency-Key: no key of 1 to 255 visible characters", "send a new UUID");
  }
  if (const auto known = requests_.find(key); known != requests_.end()) return repeat(known->second, digest);
  if (const Status status = check(key, effect); !status) return status.error();
  StoredRequest store{key, digest, std::move(effect), now, std::nullopt};
  requests_[key] = {store, false};
  ++by_user_[key.user];
  return Begun{Act{std::move(store)}};
}

Result<Idempotency::Begun> Idempotency::repeat(const Known& known, const Bytes& digest) {
  if (known.stored.digest != digest) {
    return fail(Errc::conflict, "Idempotency-Key: it was used for another request", "use a new key for a new request");
  }
  if (known.stored.answer) return Begun{*known.stored.answer};
  return Begun{Wait{kWait}};
}

std::optional<StoredRequest> Idempotency::finish(const RequestKey& key, StoredAnswer answer) {
  const auto at = requests_.find(key);
  if (at == requests_.end() || at->second.stored.answer) return std::nullopt;
  if (answer.body.size() > kMaxAnswer || long_bytes_ + long_size(answer) > kMaxLong) answer.body.clear();
  long_bytes_ += long_size(answer);
  at->second.stored.answer = std::move(answer);
  at->second.is_unsure = false;
  answered_.insert({at->second.stored.since, key});
  return at->second.stored;
}

bool Idempotency::means_not_done(Errc code) {
  return code == Errc::queue_full || code == Errc::peer_unreachable || code == Errc::peer_expired ||
         code == Errc::no_service || code == Errc::no_field_channel;
}

bool Idempotency::release(const RequestKey& key) {
  const auto at = requests_.find(key);
  if (at == requests_.end() || at->second.stored.answer) return false;
  erase(key);
  return true;
}

void Idempotency::erase(const RequestKey& key) {
  const auto at = requests_.find(key);
  if (at == requests_.end()) return;
  long_bytes_ -= long_size(at->second.stored.answer);
  requests_.erase(at);
  const auto mine = by_user_.find(key.user);
  if (--mine->second == 0) by_user_.erase(mine);
}

std::vector<StoredRequest> Idempotency::unsure(std::optional<UtcTime> before) const {
  std::vector<StoredRequest> out;
  for (const auto& [key, known] : requests_) {
    if (known.is_unsure && (!before || known.stored.since < *before)) out.push_back(known.stored);
  }
  return out;
}

std::vector<RequestKey> Idempotency::take_expired(UtcTime now) {
  std::vector<RequestKey> out;
  while (!answered_.empty() && answered_.begin()->first + kLife <= now) {
    out.push_back(answered_.begin()->second);
    answered_.erase(answered_.begin());
    erase(out.back());
  }
  return out;
}

std::vector<MovedRequest> Idempotency::move(const SteadyStep& step) {
  std::vector<MovedRequest> out;
  for (auto& [key, known] : requests_) {
    StoredRequest& stored = known.stored;
    if (!step.moves(stored.since)) continue;
    const bool was_answered = answered_.erase({stored.since, key}) > 0;
    stored.since = step.moved(stored.since);
    if (was_answered) answered_.insert({stored.since, key});
    out.push_back({key, stored.since});
  }
  return out;
}

}  // namespace trb::gateway
