// When something is said again until it is answered.
#pragma once

#include <algorithm>
#include <optional>

#include "common/base/time.hpp"

namespace trb::resilience {

/// Due at once, then after 0.2 s, doubling to 5 s.
class Backoff {
 public:
  [[nodiscard]] bool due(MonotonicTime now) const { return !next_ || *next_ <= now; }
  void said(MonotonicTime now) {
    next_ = now + wait_;
    wait_ = std::min<Duration>(wait_ * 2, std::chrono::seconds(5));
  }
  /// Nothing while it is due.
  [[nodiscard]] std::optional<MonotonicTime> next() const { return next_; }
  void reset() { *this = {}; }

 private:
  std::optional<MonotonicTime> next_;
  Duration wait_ = std::chrono::milliseconds(200);
};

}  // namespace trb::resilience
