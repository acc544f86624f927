#include "services/router/core/shared_keys.hpp"

#include <algorithm>

namespace trb::router {
namespace {

constexpr Duration kApart = std::chrono::seconds(2);  ///< a Hello that waited in a queue is not read that late
constexpr Duration kHeardAfter = std::chrono::seconds(1);
constexpr Duration kAlternates = std::chrono::seconds(10);
constexpr std::ptrdiff_t kReturns = 4;
constexpr Duration kForgotten = std::chrono::minutes(1);

/// A network that comes and goes may take a node there and back again and again.
bool is_unsteady(const std::string& endpoint) {
  return endpoint.empty() || endpoint.starts_with("169.254.") || endpoint.starts_with("[fe80:");
}

}  // namespace

SharedKeys::Seen& SharedKeys::seen(const std::string& id, BytesView key, MonotonicTime now) {
  std::erase_if(nodes_, [&](const auto& row) { return !row.second.told && now - row.second.last > kForgotten; });
  Seen& seen = nodes_[id];
  if (seen.key != key) {
    seen = {};
    seen.key = Bytes(key);
  }
  if (now - seen.last > kForgotten) seen.boot = 0;
  seen.last = now;
  return seen;
}

bool SharedKeys::on_older(const std::string& id, BytesView key, std::uint64_t boot, MonotonicTime heard,
                          MonotonicTime now) {
  Seen& seen = this->seen(id, key, now);
  if (seen.boot != boot) {
    seen.boot = boot;
    seen.first = now;
  }
  const bool both_live = now - seen.first >= kApart && heard - seen.first >= kHeardAfter;
  seen.told = seen.told || both_live;
  return both_live;
}

bool SharedKeys::on_moved(const std::string& id, BytesView key, const NodeStart& from, const NodeStart& to,
                          MonotonicTime now) {
  if (from.boot != to.boot || is_unsteady(from.address) || is_unsteady(to.address)) return false;
  Seen& seen = this->seen(id, key, now);
  std::erase_if(seen.moves, [&](const Move& one) { return now - one.at > kAlternates || one.from.boot != to.boot; });
  const bool back = std::ranges::any_of(seen.moves, [&](const Move& one) { return one.from.address == to.address; });
  seen.moves.push_back({from, now, back});
  const bool two = std::ranges::count_if(seen.moves, &Move::back) >= kReturns;
  if (two) seen.moves.clear();
  seen.told = seen.told || two;
  return two;
}

bool SharedKeys::is_over(const std::string& id, BytesView key) {
  const auto at = nodes_.find(id);
  if (at == nodes_.end() || at->second.key == key) return false;
  const bool told = at->second.told;
  nodes_.erase(at);
  return told;
}

}  // namespace trb::router
