// How long what a loop reads now may have waited for it: deadlines age by it.
#pragma once

#include <algorithm>
#include <optional>

#include "common/base/time.hpp"

namespace trb {

/// A message on its way has no clock with it. But it waits only where somebody does not read: in a process that was
/// stopped (a paused virtual machine, SIGSTOP, swap) or busy. Such a loop looks at its sockets later than it meant to,
/// and what it reads then may be as old as its last look. A stall that ends before the loop's own next deadline is not
/// seen.
class StallWatch {
 public:
  static constexpr Duration kMargin = std::chrono::milliseconds(100);   ///< a loop that is later by this was held up
  static constexpr Duration kCatchUp = std::chrono::milliseconds(100);  ///< what had waited is read by then

  /// The loop begins to wait, until this time at the latest.
  void on_wait(MonotonicTime now, MonotonicTime until) {
    if (looked_ && now - *looked_ > kMargin) held_up(now - *looked_, now);
    until_ = std::max(now, until);
  }
  /// The loop looks at its sockets.
  void on_look(MonotonicTime now) {
    if (looked_ && now > until_ + kMargin) held_up(now - *looked_, now);
    looked_ = now;
  }
  /// How long what is read now may have waited at most; 0: it came just now.
  [[nodiscard]] Duration waited(MonotonicTime now) const { return now < over_ ? length_ : Duration::zero(); }

 private:
  void held_up(Duration length, MonotonicTime now) {
    length_ = std::max(waited(now), length);
    over_ = now + kCatchUp;
  }

  std::optional<MonotonicTime> looked_;
  MonotonicTime until_{};
  MonotonicTime over_{};
  Duration length_{};
};

}  // namespace trb
