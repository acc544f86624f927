#pragma once

#include <optional>

#include "common/base/back_off.hpp"

namespace trb {

/// When to send something again until it is answered: at once, then at the intervals of a back-off.
class ResendTimer {
 public:
  constexpr ResendTimer(Duration first, Duration most) : back_off_(first, most) {}

  [[nodiscard]] bool is_due(MonotonicTime now) const { return !next_ || *next_ <= now; }
  void on_sent(MonotonicTime now) {
    next_ = now + back_off_.next();
    ++times_;
  }
  /// Empty: it has not been sent yet, and is due.
  [[nodiscard]] std::optional<MonotonicTime> next() const { return next_; }
  /// When it is due; the clock's origin if it has not been sent.
  [[nodiscard]] MonotonicTime due_at() const { return next_.value_or(MonotonicTime{}); }
  /// How often it has been sent.
  [[nodiscard]] unsigned times() const { return times_; }
  /// Makes it due at once, as at the beginning.
  void restart() {
    next_.reset();
    times_ = 0;
    back_off_.reset();
  }

 private:
  BackOff back_off_;
  std::optional<MonotonicTime> next_;
  unsigned times_ = 0;
};

}  // namespace trb
