// UTC that does not jump: for times to live and tombstones.
#pragma once

#include <optional>

#include "common/base/time.hpp"

namespace trb {

/// Runs with the monotonic clock. The machine's UTC is adopted once it has kept pace with the monotonic clock for
/// kSteady: a clock that is wrong for seconds, or set while the service runs, changes nothing. After a restart it goes
/// on
/// from the last kept time in the same way, so time without power counts as soon as the clock can be trusted.
///
/// | the machine's UTC is | first moment ever | moment after a restart | later |
/// |---|---|---|---|
/// | as it should be (kSlack) | taken | taken | followed |
/// | ahead by kShortStop at most | | taken: the service was down | a step: taken after kSteady |
/// | anything else | | a step: taken after kSteady | a step: taken after kSteady |
class SteadyTime {
 public:
  static constexpr Duration kSteady = std::chrono::minutes(10);
  static constexpr Duration kSlack = std::chrono::seconds(2);
  static constexpr Duration kShortStop = std::chrono::minutes(20);

  /// Before the first at(): the last steady time that was stored.
  void restore(UtcTime last) { restored_ = last; }
  /// The time now. Calls must not go back in time.
  UtcTime at(Now now);
  /// When a step of the clock will be adopted if it lasts; empty: there is none.
  [[nodiscard]] std::optional<MonotonicTime> next() const;

 private:
  struct Step {
    std::int64_t offset = 0;
    MonotonicTime since;
  };
  std::optional<UtcTime> restored_;
  std::optional<std::int64_t> offset_;  ///< UTC less monotonic, ns
  std::optional<Step> step_;
};

}  // namespace trb
