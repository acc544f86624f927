#pragma once

#include "common/base/back_off.hpp"

namespace trb::supervisor {

/// How long after its end a program is started again: at once if it asked for that, has been up for 10 s, or ended for
/// the first time; else after 0.1 s, doubled up to 2 s.
class RestartDelay {
 public:
  Duration after_end(bool asked, Duration was_up) {
    if (asked || was_up > kSettled) *this = RestartDelay{};
    if (fell_) return back_off_.next();
    fell_ = true;
    return Duration::zero();
  }

 private:
  static constexpr Duration kSettled = std::chrono::seconds(10);
  BackOff back_off_{std::chrono::milliseconds(100), std::chrono::seconds(2)};
  bool fell_ = false;
};

}  // namespace trb::supervisor
