// When a KUKA's flags and values are read next.
#pragma once

#include "common/base/time.hpp"

namespace trb::drivers {

class C3PollTimes {
 public:
  void restart(Now now) { next_ = next_values_ = now.mono; }
  /// Something was sent to the robot, and its flag has to be read at once.
  void soon(Now now) { next_ = now.mono; }

  [[nodiscard]] bool due(Now now) const { return now.mono >= next_; }
  /// The flags are being read; `busy`: a message is in progress.
  void polled(Now now, bool busy) { next_ = now.mono + (busy ? kBusy : kIdle); }
  /// True if the values have to be read with the flags. They count as read then.
  bool take_values(Now now) {
    if (now.mono < next_values_) return false;
    next_values_ = now.mono + kValues;
    return true;
  }
  [[nodiscard]] MonotonicTime next() const { return next_; }

 private:
  static constexpr Duration kBusy = std::chrono::milliseconds(50);
  static constexpr Duration kIdle = std::chrono::milliseconds(100);
  static constexpr Duration kValues = std::chrono::milliseconds(200);

  MonotonicTime next_;
  MonotonicTime next_values_;
};

}  // namespace trb::drivers
