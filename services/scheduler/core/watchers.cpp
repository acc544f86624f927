#include "services/scheduler/core/watchers.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "common/base/gives_way.hpp"

namespace trb::scheduler {

Status Watchers::add(const Inbound& from, double lease_s, Now now) {
  if (!(lease_s > 0 && lease_s <= kLongest_s)) {
    return fail(Errc::bad_value, "lease_s: " + std::to_string(lease_s), "use more than 0, at most 60");
  }
  forget(now.mono);
  // The upper 16 bits are the asking service's slot: its new watch follows its old one.
  std::erase_if(watchers_,
                [&](const Watcher& one) { return one.source == from.source && one.id >> 48U == from.id >> 48U; });
  if (watchers_.size() >= kMax && !make_room(from)) {
    return fail(Errc::queue_full, "8 watch already", "wait for a lease to end");
  }
  watchers_.push_back({from.source, from.id, now.mono + seconds(lease_s), {}});
  return Done{};
}

/// The own node's services come first: without its watch the resilience would see no run.
bool Watchers::make_room(const Inbound& from) {
  const bool own = from.source == from.target;
  const auto is_foreign = [&](const Watcher& one) { return one.source != from.target; };
  std::vector<std::string> foreign;
  for (const Watcher& one : watchers_) {
    if (is_foreign(one)) foreign.push_back(one.source);
  }
  const std::string source = gives_way(foreign, from.source, std::identity());
  if (!own && source == from.source) return false;
  auto newest = std::find_if(watchers_.rbegin(), watchers_.rend(),
                             [&](const Watcher& one) { return one.source == source && is_foreign(one); });
  if (newest == watchers_.rend()) newest = std::find_if(watchers_.rbegin(), watchers_.rend(), is_foreign);
  if (newest == watchers_.rend()) return false;
  watchers_.erase(std::prev(newest.base()));
  return true;
}

void Watchers::forget(MonotonicTime now) {
  std::erase_if(watchers_, [&](const Watcher& one) { return one.until <= now; });
}

void Watchers::leave(const RunSummary& last, Outbox& out) {
  for (Watcher& watcher : watchers_) {
    watcher.sent.erase(last.run);
    out.sends.push_back({.target = watcher.source, .reply_to = watcher.id, .body = RunChanged{last}});
  }
}

void Watchers::note_sent(const Inbound& from, const std::string& run, std::uint64_t version) {
  for (Watcher& watcher : watchers_) {
    if (watcher.source == from.source && watcher.id == from.id) watcher.sent[run] = version;
  }
}

}  // namespace trb::scheduler
