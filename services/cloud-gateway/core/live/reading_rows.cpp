#include "services/cloud-gateway/core/live/reading_rows.hpp"

#include <algorithm>

namespace trb::gateway {

void ReadingRows::take(const std::string& node, const SensorReading& reading, Live live, Now now, Outbox& out) {
  if (book_.find({RowKind::sensor, node, reading.sensor}) == nullptr) return out.count("dropped.unknown_sensor");
  const RowKey key{RowKind::reading, node, reading.sensor};
  const auto at = seen_.find(key);
  const bool same_watch = at != seen_.end() && reading.watch != 0 && reading.watch == at->second.watch;
  // One that was measured later is no late one: a sensor-bus that was started anew counts from 1 again.
  const bool is_late = same_watch && reading.count < at->second.count && reading.time <= at->second.time;
  if (is_late) return out.count("dropped.late");
  const Live shown = live == Live::live && reading.quality == "stale" ? Live::late : live;
  if (!book_.put(key, reading, shown, now)) return out.count("refused.node_budget");
  if (same_watch && reading.count == at->second.count) return;
  Seen& seen = seen_[key];
  expect_next(key, seen, now);
  seen.watch = reading.watch;
  seen.count = reading.count;
  seen.time = reading.time;
}

void ReadingRows::expect_next(const RowKey& key, Seen& seen, Now now) {
  const Duration gap = seen.at == MonotonicTime{} ? kShortest : 3 * std::min<Duration>(now.mono - seen.at, kLongest);
  due_.erase({seen.due, key});
  seen.at = now.mono;
  seen.due = now.mono + std::clamp<Duration>(gap, kShortest, kLongest);
  due_.insert({seen.due, key});
}

void ReadingRows::tick(Now now) {
  while (!due_.empty() && due_.begin()->first <= now.mono) {
    const RowKey key = due_.begin()->second;
    due_.erase(due_.begin());
    const Row* row = book_.find(key);
    if (row == nullptr) {
      seen_.erase(key);
      continue;
    }
    seen_[key].watch = 0;
    if (row->live == Live::live) book_.set_live(key, Live::late, now);
  }
}

std::optional<MonotonicTime> ReadingRows::next_deadline() const {
  if (due_.empty()) return std::nullopt;
  return due_.begin()->first;
}

}  // namespace trb::gateway
