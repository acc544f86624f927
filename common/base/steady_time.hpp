// UTC that does not jump: for times to live and tombstones.
#pragma once

#include <optional>
#include <utility>

#include "common/base/time.hpp"

namespace trb {

/// A step of the clock that was taken over: the times that were told before it were wrong by as much, not their
/// distances.
struct SteadyStep {
  std::optional<UtcTime> after;  ///< the first time told since the start; empty: those kept before it are meant, too
  UtcTime until;                 ///< the last time told before the step
  Duration by{};

  /// Was that time told by the clock before the step?
  [[nodiscard]] bool moves(UtcTime time) const { return time <= until && (!after || time > *after); }
  /// That time, told anew.
  [[nodiscard]] UtcTime moved(UtcTime time) const { return moves(time) ? time + by : time; }
};

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
///
/// What keeps times of this clock moves those that a step moves (take_step), or all that began minutes ago would be
/// hours old at once. Times kept before a long stop are not moved: the step is the time of the stop.
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
  /// After each at(): the step that it has taken over.
  std::optional<SteadyStep> take_step() { return std::exchange(taken_, std::nullopt); }

 private:
  struct Step {
    std::int64_t offset = 0;
    MonotonicTime since;
  };
  void take_over(Duration by);

  std::optional<UtcTime> restored_;
  std::optional<std::int64_t> offset_;  ///< UTC less monotonic, ns
  std::optional<Step> step_;
  std::optional<UtcTime> first_;  ///< the first told, by the offset of now; empty: it went on after a short stop
  UtcTime last_;                  ///< told
  std::optional<SteadyStep> taken_;
};

}  // namespace trb
