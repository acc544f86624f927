#include "services/router/core/router_core.hpp"

#include "common/base/address.hpp"

namespace trb::router {

RouterCore::RouterCore(RouterConfig config) : config_(std::move(config)), services_(config_.first_slot) {
  for (const SeedAddress& seed : config_.seeds) {
    if (seed.key != config_.own.link_key.bytes) seeds_.push_back({seed.address, seed.key, {}, {}});
  }
  for (const SeedAddress& hint : config_.known) {
    if (!is_numeric_endpoint(hint.address)) continue;  // as an earlier release stored it
    if (hint.key != config_.own.link_key.bytes && !is_expected(hint.key))
      seeds_.push_back({hint.address, hint.key, {}, {}, true});
  }
}

void RouterCore::start(Now now, Effects& out) {
  started_ = now.mono;
  out.log(LogLevel::info, "started", config_.id + " at " + config_.address + ", boot " + std::to_string(config_.boot));
  for (Seed& seed : seeds_) seed.redial.at = now.mono;
  if (config_.beacon && !config_.address.empty()) next_beacon_ = now.mono;
  clock_.start(config_.utc_bound, now);
  if (checked_utc(now.utc) != now.utc) {
    out.log(LogLevel::warning, "clock_unverified",
            "the clock says " + to_iso8601(now.utc) + ", but it is " + to_iso8601(checked_utc(now.utc)) +
                " at least: set it; if it was ahead before, remove state/utc");
  }
  // What was in force before this start is now, before the first link; each of it is checked anew.
  on_news_of_file(config_.news, now, out);
  check_own(now, out);
  if (!config_.boot_stored) on_stored(Kept::boot, config_.boot_stored, now, out);
}

const Link* RouterCore::find_link(LinkId id) const {
  const auto at = links_.find(id);
  return at == links_.end() ? nullptr : &at->second;
}

std::uint64_t RouterCore::counter(std::string_view name) const {
  const auto at = counts_.find(name);
  return at == counts_.end() ? 0 : at->second;
}

void RouterCore::count(std::string_view name, std::uint64_t by) {
  const auto at = counts_.find(name);
  if (at != counts_.end()) {
    at->second += by;
  } else if (counts_.size() < 1000) {
    counts_.emplace(name, by);
  }
}

namespace {

constexpr std::size_t kRoutePage = 256U << 10U;  ///< of it a row takes 66 kB at most
constexpr std::size_t kRouteWords = 512;         ///< a row's own words and numbers, at most

}  // namespace

Route RouterCore::route_of(const Peer& peer, Now now) const {
  const Link* link = find_link(peer.link);
  const Link* relay = link == nullptr ? relay_of(peer) : nullptr;
  const std::string state = link != nullptr || relay != nullptr ? "ONLINE"
                            : peer.expired || !peer.met         ? "OFFLINE"
                                                                : "CONNECTION_BROKEN";
  const MonotonicTime heard = link != nullptr    ? link->last_heard
                              : relay != nullptr ? peer.road.last_sign()
                                                 : peer.last_heard;
  return {peer.id,
          peer.certificate.role,
          peer.address,
          state,
          to_seconds(now.mono - heard),
          peer.boot,
          peer.link,
          link == nullptr ? ""
          : link->dialled ? config_.id
                          : peer.id,
          peer.version,
          peer.clock_verified ? "verified" : "unverified",
          peer.certificate_record,
          peer.profile,
          relay == nullptr ? "" : relay->peer};
}

RouteTable RouterCore::route_table(Now now, const std::string& after) const {
  RouteTable table{config_.id, {}, false, after};
  std::size_t size = 0;
  const auto add = [&](Route&& route) {
    size += kRouteWords + encode(route.certificate).size() + encode(route.profile).size();
    // The first always has room, and this node's own row is never the last: the cursor runs over peers.
    table.more = size > kRoutePage && table.routes.size() > 1;
    if (!table.more) table.routes.push_back(std::move(route));
    return !table.more;
  };
  if (after.empty()) {
    const bool verified = checked_utc(now.utc) == now.utc;
    add({config_.id, config_.role, config_.address, "self", 0, config_.boot, 0, "", config_.version,
         verified ? "verified" : "unverified", config_.certificate, profile_, ""});
  }
  for (auto at = peers_.upper_bound(after); at != peers_.end(); ++at) {
    if (!add(route_of(at->second, now))) break;
  }
  return table;
}

}  // namespace trb::router
