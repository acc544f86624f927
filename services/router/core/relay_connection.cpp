#include "services/router/core/relay_connection.hpp"

#include <algorithm>
#include <utility>

namespace trb::router {

const Unconfirmed* RelayConnection::find(std::uint64_t count) const {
  const auto at = std::ranges::find(unconfirmed_, count, &Unconfirmed::count);
  return at == unconfirmed_.end() ? nullptr : &*at;
}

std::optional<Unconfirmed> RelayConnection::withdraw(std::uint64_t count) {
  const auto at = std::ranges::find(unconfirmed_, count, &Unconfirmed::count);
  if (at == unconfirmed_.end()) return std::nullopt;
  Unconfirmed out = std::move(*at);
  unconfirmed_.erase(at);
  return out;
}

void RelayConnection::begin(MonotonicTime at) {
  wait_ = {};
  unanswered_ = 0;
  send_by(at);
}

void RelayConnection::send_by(MonotonicTime at) {
  // To send one costs more than to answer it; even so, answers are limited to one in this time.
  next_alive_ = earlier(next_alive_, std::max(at, last_alive_ + timing_.acknowledge));
}

RelayAlive RelayConnection::make_alive(RelayAlive own, std::uint64_t nonce, MonotonicTime now) {
  constexpr std::size_t kNonces = 8;
  if (nonces_.size() >= kNonces) nonces_.erase(nonces_.begin());
  nonces_.push_back({nonce, now});
  wait_ = since_ ? timing_.alive : std::clamp(wait_ * 2, timing_.first, timing_.most);
  last_alive_ = now;
  next_alive_ = now + wait_;
  untold_ = 0;
  ++unanswered_;
  own.nonce = nonce;
  own.echo = echo_;
  own.echo_other = echo_other_;
  own.heard_boot = since_ ? boot_ : 0;
  own.heard = highest_;
  own.mask = mask_;
  return own;
}

RelayConnection::Received RelayConnection::on_alive(const RelayAlive& alive, std::uint64_t boot, std::uint64_t count,
                                                    MonotonicTime now) {
  Received out;
  const auto nonce = std::find_if(nonces_.begin(), nonces_.end(), [&](const Nonce& one) {
    return (one.value == alive.echo || one.value == alive.echo_other) && now < one.sent + timing_.lease;
  });
  const bool same_boot = boot == boot_ && boot_ != 0;
  if (same_boot && !take(boot, count, false, now)) return out;  // a repeat
  out.fresh = nonce != nonces_.end();
  if (!out.fresh) {
    // The other side has not received ours, or a relay replays an old one: answering is cheap, and proves nothing.
    (same_boot ? echo_ : echo_other_) = alive.nonce;
    send_by(now);
    return out;
  }
  out.new_boot = !since_ || !same_boot;
  if (!same_boot) out.lost = restart(boot, count);
  echo_ = alive.nonce;
  since_ = std::max(since_.value_or(nonce->sent), nonce->sent);
  last_sign_ = *since_;
  unanswered_ = 0;
  knows_us_ = alive.heard_boot == own_boot_;
  if (out.new_boot || !knows_us_) send_by(now);
  if (knows_us_) settle(alive, out.lost);
  return out;
}

/// The other side was restarted: counts begin anew, and what the old boot did not confirm is lost.
std::vector<Unconfirmed> RelayConnection::restart(std::uint64_t boot, std::uint64_t count) {
  boot_ = boot;
  highest_ = count;
  mask_ = 1;
  echo_other_ = 0;
  return take_all();
}

/// Messages that the other side reports as received are confirmed; missing ones, if later ones arrived, are lost.
void RelayConnection::settle(const RelayAlive& alive, std::vector<Unconfirmed>& lost) {
  while (!unconfirmed_.empty() && unconfirmed_.front().count <= alive.heard) {
    const std::uint64_t behind = alive.heard - unconfirmed_.front().count;
    const bool taken = behind < kWindow && ((alive.mask >> behind) & 1U) != 0;
    if (!taken) lost.push_back(std::move(unconfirmed_.front()));
    unconfirmed_.pop_front();
  }
}

bool RelayConnection::take(std::uint64_t boot, std::uint64_t count, bool answer, MonotonicTime now) {
  if (boot != boot_ || boot_ == 0 || count == 0) return false;
  if (count > highest_) {
    const std::uint64_t ahead = count - highest_;
    mask_ = ahead < kWindow ? (mask_ << ahead) | 1U : 1U;
    highest_ = count;
  } else {
    const std::uint64_t behind = highest_ - count;
    if (behind >= kWindow || ((mask_ >> behind) & 1U) != 0) return false;
    mask_ |= std::uint64_t{1} << behind;
  }
  if (!answer) return true;
  ++untold_;
  send_by(untold_ >= kAcknowledgeEach ? now : now + timing_.acknowledge);
  return true;
}

std::vector<Unconfirmed> RelayConnection::overdue(MonotonicTime now) {
  std::vector<Unconfirmed> out;
  while (!unconfirmed_.empty() && now >= unconfirmed_.front().sent + timing_.confirmed_in) {
    out.push_back(std::move(unconfirmed_.front()));
    unconfirmed_.pop_front();
  }
  return out;
}

std::vector<Unconfirmed> RelayConnection::take_all() {
  const auto all = std::exchange(unconfirmed_, {});
  return {all.begin(), all.end()};
}

bool RelayConnection::lapse(MonotonicTime now) {
  if (!since_ || now < *since_ + timing_.lease) return false;
  since_.reset();
  knows_us_ = false;
  return true;
}

std::optional<MonotonicTime> RelayConnection::next_deadline() const {
  std::optional<MonotonicTime> next = next_alive_;
  if (since_) next = earlier(next, *since_ + timing_.lease);
  if (!unconfirmed_.empty()) next = earlier(next, unconfirmed_.front().sent + timing_.confirmed_in);
  return next;
}

}  // namespace trb::router
