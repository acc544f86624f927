#pragma once

#include <algorithm>

#include "common/base/time.hpp"

namespace trb {

/// The waits between tries: `first`, then twice as long each time, `most` at most.
class BackOff {
 public:
  constexpr BackOff(Duration first, Duration most) : first_(first), most_(most), wait_(first) {}

  /// How long to wait before the next try.
  Duration next() {
    const Duration out = wait_;
    wait_ = std::min(wait_ * 2, most_);
    return out;
  }
  void reset() { wait_ = first_; }

 private:
  Duration first_;
  Duration most_;
  Duration wait_;
};

}  // namespace trb
