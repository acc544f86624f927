// One robot's share of what is written at once: a robot whose texts change with every message would cost a commit each.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "common/base/time.hpp"

namespace trb::resilience {

class WriteShare {
 public:
  static constexpr std::int64_t kMost = 64;
  static constexpr Duration kEach = std::chrono::seconds(3);  ///< one more: values are written as often

  /// False: it is used up. What has changed is written with the values, and a line of the history is left out.
  bool take(UtcTime now) {
    if (now < since_) since_ = now;  // the clock was put back
    const std::int64_t more = (now.ns - since_.ns) / kEach.count();
    since_ = since_ + more * kEach;
    left_ = std::min(kMost, left_ + more);
    if (left_ == 0) return false;
    --left_;
    return true;
  }
  void leave_out() { ++left_out_; }
  /// The lines that were left out since the last call.
  std::uint64_t take_left_out() { return std::exchange(left_out_, 0); }

 private:
  std::int64_t left_ = kMost;
  std::uint64_t left_out_ = 0;
  UtcTime since_;
};

}  // namespace trb::resilience
