#include "services/router/core/troubles.hpp"

#include <algorithm>

#include "common/base/saturate.hpp"
#include "services/router/core/router_core.hpp"

namespace trb::router {

void Troubles::note(std::string_view peer, std::string_view address, std::string_view code, std::string_view text,
                    MonotonicTime now) {
  const auto key = std::make_tuple(std::string(peer), std::string(address), std::string(code));
  if (rows_.count(key) == 0 && rows_.size() >= kMaxTroubles) forget_oldest();
  Trouble& row = rows_[key];
  row.text = text;
  row.last = now;
  ++row.count;
}

void Troubles::forget_oldest() {
  rows_.erase(std::min_element(rows_.begin(), rows_.end(),
                               [](const auto& a, const auto& b) { return a.second.last < b.second.last; }));
}

void Troubles::recovered(std::string_view peer, std::string_view address) {
  std::erase_if(rows_, [&](const auto& row) {
    const auto& [of, at, code] = row.first;
    return (!peer.empty() && of == peer) || (!address.empty() && at == address);
  });
}

LinkTroubles Troubles::table(const std::string& node, MonotonicTime now) const {
  LinkTroubles out{node, {}};
  for (const auto& [key, row] : rows_) {
    const auto& [peer, address, code] = key;
    out.troubles.push_back({peer, address, code, row.text, row.count, to_seconds(now - row.last)});
  }
  std::stable_sort(out.troubles.begin(), out.troubles.end(),
                   [](const LinkTrouble& a, const LinkTrouble& b) { return a.last_s < b.last_s; });
  return out;
}

namespace {

/// Clocks that are further apart than this make certificates and schedules go wrong before anybody sees why.
constexpr std::int64_t kClockApart = 60'000'000'000;

}  // namespace

void RouterCore::note_trouble(LinkId id, std::string_view code, std::string_view text, Now now) {
  const auto at = links_.find(id);
  if (at == links_.end()) return troubles_.note("", "", code, text, now.mono);
  const Link& link = at->second;
  if (link.up) return troubles_.note(link.peer, "", code, text, now.mono);
  for (const Seed& seed : seeds_) {
    if (seed.redial.link == id) return troubles_.note(seed.peer, seed.address, code, text, now.mono);
  }
  for (const auto& [name, peer] : peers_) {
    if (peer.redial.link == id) return troubles_.note(name, peer.address, code, text, now.mono);
  }
}

void RouterCore::note_up(const Link& link, const Hello& hello, Now now) {
  troubles_.recovered(link.peer, hello.address);
  for (const Seed& seed : seeds_) {
    if (seed.key == link.key) troubles_.recovered(link.peer, seed.address);
  }
  const std::int64_t apart = saturating_sub(hello.utc, now.utc.ns);
  if (apart <= kClockApart && apart >= -kClockApart) return;
  troubles_.note(link.peer, "", "clock_off",
                 "its clock is " + std::to_string(apart / 1'000'000'000) + " s away from this node's", now.mono);
}

}  // namespace trb::router
