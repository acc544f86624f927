// Which connections are looked at now. The kernel is asked about each (1.5 us), so all of a thousand at one time would
// hold the loop up for as long as a thousand messages do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "common/base/time.hpp"

namespace trb::router {

/// A part of a round; the default is a whole one.
struct LookPart {
  std::size_t number = 0;  ///< from 0
  std::size_t parts = 1;
};

/// When which part is due: a round takes kPeriod, a part kMost connections of each kind.
class LookRound {
 public:
  /// In this time an attacker fills what its network, or the thread that decrypts, carries.
  static constexpr Duration kPeriod = std::chrono::milliseconds(250);
  static constexpr std::size_t kMost = 64;

  [[nodiscard]] MonotonicTime next() const { return next_; }
  /// The part that is due. `connections`: of the kind of which there are most; what counts is their number when a round
  /// begins.
  LookPart step(MonotonicTime now, std::size_t connections) {
    if (++part_.number >= part_.parts) part_ = {0, std::max<std::size_t>(1, (connections + kMost - 1) / kMost)};
    next_ = std::max(now, next_ + kPeriod / static_cast<std::int64_t>(part_.parts));
    return part_;
  }

 private:
  LookPart part_;
  MonotonicTime next_{};
};

/// Goes through a map whose keys are numbers from 1. Each row that is there when the round begins is visited once in
/// it; a row of a higher key waits for the next one.
class LookCursor {
 public:
  /// `visit` gets key and value; it must not change the map.
  template <class Rows, class Visit>
  void visit(Rows& rows, const LookPart& part, Visit visit) {
    if (part.number == 0) begin(rows, part.parts);
    const bool is_last = part.number + 1 == part.parts;
    std::size_t left = is_last ? rows.size() : share_;
    for (auto at = rows.upper_bound(last_); left > 0 && at != rows.end() && at->first <= end_; ++at, --left) {
      last_ = at->first;
      visit(at->first, at->second);
    }
  }

 private:
  template <class Rows>
  void begin(const Rows& rows, std::size_t parts) {
    last_ = 0;
    end_ = rows.empty() ? 0 : rows.rbegin()->first;
    share_ = (rows.size() + parts - 1) / parts;
  }

  std::uint64_t last_ = 0;  ///< visited
  std::uint64_t end_ = 0;   ///< the round's last key
  std::size_t share_ = 0;   ///< rows in a part
};

}  // namespace trb::router
