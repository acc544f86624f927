#include "services/router/core/link_errors.hpp"

#include <algorithm>

#include "common/base/gives_way.hpp"
#include "common/base/saturate.hpp"
#include "services/router/core/shared_keys.hpp"

namespace trb::router {
namespace {

constexpr std::int64_t kClockApart = 60'000'000'000;

}  // namespace

void LinkErrors::note(std::string_view peer, std::string_view address, std::string_view code, std::string_view text,
                      Now now) {
  const auto key = std::make_tuple(std::string(peer), std::string(address), std::string(code));
  if (rows_.count(key) == 0 && rows_.size() >= kMaxLinkErrors) make_room(peer);
  Row& row = rows_[key];
  row.text = text;
  row.last = now.mono;
  ++row.count;
}

/// A peer that is at ever new addresses has a row for each: it pushes out its own.
void LinkErrors::make_room(std::string_view peer) {
  const auto peer_of = [](const auto& row) -> const std::string& { return std::get<0>(row.first); };
  const std::string of = gives_way(rows_, peer, peer_of);
  const auto rank = [&](const auto& row) { return std::pair(peer_of(row) != of, row.second.last); };
  rows_.erase(std::ranges::min_element(rows_, {}, rank));
}

void LinkErrors::note_link(LinkId id, std::string_view code, std::string_view text, Now now) {
  const Link* link = table_.link(id);
  if (link == nullptr) return note("", "", code, text, now);
  if (link->up) return note(link->peer, "", code, text, now);
  for (const Seed& seed : table_.seeds()) {
    if (seed.redial.link == id) return note(seed.peer, seed.address, code, text, now);
  }
  const Peer* peer = table_.find(link->dialled_for);
  if (peer != nullptr && peer->redial.link == id) note(peer->id, peer->address, code, text, now);
}

void LinkErrors::recovered(std::string_view peer, std::string_view address) {
  std::erase_if(rows_, [&](const auto& row) {
    const auto& [of, at, code] = row.first;
    // Whose link it is that came up, nobody knows.
    if (code == kSharedKeys) return false;
    return (!peer.empty() && of == peer) || (!address.empty() && at == address);
  });
}

void LinkErrors::forget(std::string_view peer, std::string_view code) {
  rows_.erase({std::string(peer), "", std::string(code)});
}

void LinkErrors::note_up(const Link& link, const Hello& hello, Now now) {
  recovered(link.peer, hello.address);
  for (const Seed& seed : table_.seeds()) {
    if (seed.key == link.key) recovered(link.peer, seed.address);
  }
  note_clock(link.peer, hello.utc, now);
}

void LinkErrors::note_clock(std::string_view peer, std::int64_t utc, Now now) {
  const std::int64_t apart = saturating_sub(utc, now.utc.ns);
  if (apart <= kClockApart && apart >= -kClockApart) {
    rows_.erase({std::string(peer), "", "clock_off"});
    return;
  }
  note(peer, "", "clock_off", "its clock is " + std::to_string(apart / 1'000'000'000) + " s away from this node's",
       now);
}

LinkErrorTable LinkErrors::table(const std::string& node, MonotonicTime now) const {
  LinkErrorTable out{node, {}};
  for (const auto& [key, row] : rows_) {
    const auto& [peer, address, code] = key;
    out.errors.push_back({peer, address, code, row.text, row.count, to_seconds(now - row.last)});
  }
  std::stable_sort(out.errors.begin(), out.errors.end(),
                   [](const LinkErrorRow& a, const LinkErrorRow& b) { return a.last_s < b.last_s; });
  return out;
}

}  // namespace trb::router
