// A lower bound of the time, for a start with a clock that is behind. A clock may also be far ahead for a moment (a GPS
// receiver, a wrong server); that must not be stored for ever.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "common/base/time.hpp"

namespace trb::router {

constexpr Duration kClockSteady =
    std::chrono::minutes(10);  ///< in step with the monotonic clock, before it is believed
constexpr Duration kClockJump = std::chrono::seconds(2);
constexpr Duration kClockAhead = std::chrono::minutes(5);  ///< of the peers' clocks: too much
constexpr Duration kStoreTime = std::chrono::minutes(10);  ///< a Raspberry Pi's card wears out by writes

/// Asked only when they are needed.
using PeerClocks = std::function<std::vector<std::int64_t>()>;

class ClockBound {
 public:
  /// `stored`: what an earlier start stored.
  void start(UtcTime stored, Now now);
  [[nodiscard]] UtcTime bound() const { return bound_; }

  /// The authority has signed something at this time, so it has passed.
  void raise(UtcTime utc);

  /// Each turn: notices a jump of the clock.
  void watch(Now now);
  /// Has the clock run in step with the monotonic clock for kClockSteady?
  [[nodiscard]] bool is_steady(Now now) const;
  /// The time to store now, if the clock is steady, the time is not stored yet, and no majority of the peers' clocks
  /// says that this clock is ahead. `clocks`: UTC at monotonic 0 by each of their verified clocks.
  std::optional<UtcTime> to_store(Now now, const PeerClocks& clocks);

 private:
  UtcTime bound_;
  UtcTime stored_;
  std::int64_t offset_ = 0;  ///< UTC at monotonic 0, when the clock jumped last or was stored
  MonotonicTime since_;      ///< of that jump
};

}  // namespace trb::router
