// A time that has certainly passed: for a start with a clock that is behind. A clock may also be far ahead for a
// moment, of a GPS receiver or a wrong server; what it said then must not count for ever.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/time.hpp"

namespace trb::router {

constexpr Duration kClockSteady =
    std::chrono::minutes(10);  ///< in step with the monotonic clock, before it is believed
constexpr Duration kClockJump = std::chrono::seconds(2);
constexpr Duration kClockAhead = std::chrono::minutes(5);  ///< of the peers' clocks: too much
constexpr Duration kStoreTime = std::chrono::minutes(10);  ///< a Raspberry Pi's card wears out by writes

class ClockBound {
 public:
  /// `stored`: what an earlier start has left.
  void start(UtcTime stored, Now now);
  [[nodiscard]] UtcTime bound() const { return bound_; }

  /// By a word of the authority that time has passed.
  void raise(UtcTime utc);

  /// Each turn: has the clock jumped?
  void watch(Now now);
  /// It has run in step with the monotonic clock for kClockSteady.
  [[nodiscard]] bool is_steady(Now now) const;
  /// The time to be stored now, if it is steady, is not stored yet, and no majority of the peers' clocks says that it
  /// is ahead. `peers`: by each of their verified clocks, UTC at monotonic 0.
  std::optional<UtcTime> to_store(Now now, const std::vector<std::int64_t>& peers);

 private:
  UtcTime bound_;
  UtcTime stored_;
  std::int64_t offset_ = 0;  ///< UTC at monotonic 0, when the clock jumped last or was stored
  MonotonicTime since_;      ///< of that jump
};

}  // namespace trb::router
