#pragma once

#include <cmath>

namespace trb::adapter {

/// A robot tells its numbers in decimals: what was 0.1 here need not be the same double there.
inline bool same_number(double a, double b) {
  return std::abs(a - b) < 1e-9;
}

}  // namespace trb::adapter
