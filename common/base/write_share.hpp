// One sender's share of what is written at once: a robot whose texts change with every message would cost a commit
// each.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "common/base/time.hpp"

namespace trb {

class WriteShare {
 public:
  static constexpr std::int64_t kMost = 64;
  static constexpr Duration kEach = std::chrono::seconds(3);  ///< one more: a robot's values are written as often

  /// `most` at once, and one more every `each`.
  explicit WriteShare(std::int64_t most = kMost, Duration each = kEach) : most_(most), each_(each), left_(most) {}

  /// False: it is used up. What has changed is written later, or left out.
  bool take(UtcTime now) {
    if (now < since_) since_ = now;  // the clock was put back
    const std::int64_t more = (now.ns - since_.ns) / each_.count();
    since_ = since_ + more * each_;
    left_ = std::min(most_, left_ + more);
    if (left_ == 0) return false;
    --left_;
    return true;
  }
  void leave_out() { ++left_out_; }
  /// What was left out since the last call.
  std::uint64_t take_left_out() { return std::exchange(left_out_, 0); }

 private:
  std::int64_t most_;
  Duration each_;
  std::int64_t left_;
  std::uint64_t left_out_ = 0;
  UtcTime since_;
};

}  // namespace trb
