// What is due when, for many rows: the earliest is known at once, without a walk over all of them.
#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/base/time.hpp"

namespace trb {

/// A row keeps its slot: when the index holds it to be due. Only set() changes a slot, and a row that goes is taken out
/// first (set() with nothing).
template <class Key, class Time = MonotonicTime>
class DeadlineIndex {
 public:
  using Slot = std::optional<Time>;

  /// That row is due then, or (nothing) never.
  void set(const Key& key, Slot& slot, const std::optional<Time>& due) {
    if (slot == due) return;
    if (slot && due) {
      auto row = rows_.extract({*slot, key});  // its memory is used again
      row.value().first = *due;
      rows_.insert(std::move(row));
    } else if (slot) {
      rows_.erase({*slot, key});
    } else {
      rows_.emplace(*due, key);
    }
    slot = due;
  }

  [[nodiscard]] std::optional<Time> earliest() const {
    return rows_.empty() ? std::nullopt : std::optional(rows_.begin()->first);
  }
  /// Those that are due by then, the earliest first.
  [[nodiscard]] std::vector<Key> due(Time now) const {
    std::vector<Key> out;
    for (auto at = rows_.begin(); at != rows_.end() && at->first <= now; ++at) out.push_back(at->second);
    return out;
  }
  /// All that have a deadline, the earliest first.
  [[nodiscard]] const std::set<std::pair<Time, Key>>& rows() const { return rows_; }

 private:
  std::set<std::pair<Time, Key>> rows_;
};

}  // namespace trb
