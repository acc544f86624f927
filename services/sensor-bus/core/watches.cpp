#include "services/sensor-bus/core/watches.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/gives_way.hpp"

namespace trb::sensor {
namespace {

constexpr std::size_t kMaxWatches = 256;
constexpr double kShortestEvery_s = 0.01;
constexpr double kLongestEvery_s = 86'400;
constexpr double kLongestLease_s = 60;

}  // namespace

bool Watches::make_room(const std::string& asking, const Error& why, Outbox& out) {
  const auto node_of = [](const auto& one) { return std::get<1>(one.first); };
  const std::string other = gives_way(watches_, asking, node_of);
  if (other == asking) return false;
  const auto last =
      std::find_if(watches_.rbegin(), watches_.rend(), [&](const auto& one) { return node_of(one) == other; });
  end(last->first, last->second, why, out);
  watches_.erase(std::next(last).base());
  changed_ = true;
  return true;
}

Status Watches::order(const Inbound& asked, const SensorWatch& body, const std::string& name, Now now, Outbox& out) {
  if (!(body.lease_s >= 0)) return fail(Errc::bad_value, "lease_s: is no number of seconds", "60 at most, 0 ends it");
  if (!(body.every_s >= 0)) return fail(Errc::bad_value, "every_s: is no number of seconds", "0.01 at least");
  const Key key{name, asked.source, asked.id >> 48U, body.watch};
  if (body.lease_s == 0) {
    drop([&](const auto& one) { return one.first == key; });
    return Done{};
  }
  if (watches_.count(key) == 0) {
    const Error full =
        fail(Errc::queue_full, "the sensors of this node are watched 256 times already", "wait until some end");
    if (watches_.size() >= kMaxWatches && !make_room(asked.source, full, out)) return full;
    changed_ = true;
  }
  Watch& watch = watches_[key];
  watch.request = asked.id;
  watch.every = seconds(std::clamp(body.every_s, kShortestEvery_s, kLongestEvery_s));
  watch.until = now.mono + seconds(std::min(body.lease_s, kLongestLease_s));
  return Done{};
}

void Watches::send(const Key& key, Watch& watch, SensorReading reading, Outbox& out) {
  reading.watch = std::get<3>(key);
  reading.count = ++watch.count;
  out.sends.push_back({.type = MessageType::information,
                       .target = std::get<1>(key),
                       .reply_to = watch.request,
                       .flags = kFlagLossy,
                       .body = std::move(reading)});
}

void Watches::send(const std::string& name, const SensorReading& reading, Now now, Outbox& out) {
  for (auto at = first_of(name); at != watches_.end() && std::get<0>(at->first) == name; ++at) {
    Watch& watch = at->second;
    // A sensor's own period is never exact: what comes a little early is not left to the next one.
    const Duration early = watch.every / 10;
    if (watch.next && now.mono + early < *watch.next) continue;
    const bool in_step = watch.next && now.mono < *watch.next + watch.every;
    watch.next = (in_step ? *watch.next : now.mono) + watch.every;
    send(at->first, watch, reading, out);
  }
}

void Watches::send_at_once(const std::string& name, const SensorReading& reading, Outbox& out) {
  for (auto at = first_of(name); at != watches_.end() && std::get<0>(at->first) == name; ++at) {
    send(at->first, at->second, reading, out);
  }
}

/// Its requester hears that nothing more comes.
void Watches::end(const Key& key, const Watch& watch, const Error& why, Outbox& out) {
  out.sends.push_back({.type = MessageType::information,
                       .target = std::get<1>(key),
                       .reply_to = watch.request,
                       .body = Nack{std::string(errc_name(why.code)), std::string(SensorWatch::kSubtype),
                                    std::get<0>(key), why.what, why.hint}});
}

void Watches::end_of(const std::string& name, const Error& why, Outbox& out) {
  for (auto at = first_of(name); at != watches_.end() && std::get<0>(at->first) == name;) {
    end(at->first, at->second, why, out);
    at = watches_.erase(at);
    changed_ = true;
  }
}

void Watches::forget_node(const std::string& id) {
  drop([&](const auto& one) { return std::get<1>(one.first) == id; });
}

void Watches::expire(MonotonicTime now) {
  drop([&](const auto& one) { return one.second.until <= now; });
}

std::optional<MonotonicTime> Watches::next_deadline() const {
  std::optional<MonotonicTime> next;
  for (const auto& [key, watch] : watches_) next = earlier(next, watch.until);
  return next;
}

std::set<std::string> Watches::names() const {
  std::set<std::string> out;
  for (const auto& [key, watch] : watches_) out.insert(std::get<0>(key));
  return out;
}

bool Watches::any_of(const std::string& name) const {
  const auto at = watches_.lower_bound(Key{name, "", 0, 0});
  return at != watches_.end() && std::get<0>(at->first) == name;
}

}  // namespace trb::sensor
