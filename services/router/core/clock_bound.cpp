#include "services/router/core/clock_bound.hpp"

#include <algorithm>

#include "common/base/saturate.hpp"

namespace trb::router {
namespace {

std::int64_t offset_of(Now now) {
  return saturating_sub(now.utc.ns, now.mono.ns);
}

bool is_apart(std::int64_t a, std::int64_t b, Duration most) {
  const std::int64_t apart = saturating_sub(a, b);
  return apart > most.count() || apart < -most.count();
}

}  // namespace

void ClockBound::start(UtcTime stored, Now now) {
  bound_ = stored_ = stored;
  offset_ = offset_of(now);
  since_ = now.mono;
}

void ClockBound::raise(UtcTime utc) {
  bound_ = stored_ = std::max(bound_, utc);
}

void ClockBound::watch(Now now) {
  if (!is_apart(offset_of(now), offset_, kClockJump)) return;
  offset_ = offset_of(now);
  since_ = now.mono;
}

bool ClockBound::is_steady(Now now) const {
  return !is_apart(offset_of(now), offset_, kClockJump) && now.mono - since_ >= kClockSteady;
}

std::optional<UtcTime> ClockBound::to_store(Now now, const PeerClocks& clocks) {
  const bool fresh = saturating_sub(now.utc.ns, stored_.ns) >= kStoreTime.count();
  if (!fresh || !is_steady(now)) return std::nullopt;
  const std::vector<std::int64_t> peers = clocks();
  const auto behind = std::count_if(peers.begin(), peers.end(), [&](std::int64_t peer) {
    return saturating_sub(offset_of(now), peer) > kClockAhead.count();
  });
  if (static_cast<std::size_t>(behind) * 2 > peers.size()) return std::nullopt;
  stored_ = now.utc;
  offset_ = offset_of(now);  // small corrections by a time server are no jump
  return now.utc;
}

}  // namespace trb::router
