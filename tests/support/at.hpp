// Times of a test that begins at 0.
#pragma once

#include "common/base/time.hpp"

namespace trb {

inline Now at(double s) {
  return {MonotonicTime{} + seconds(s), UtcTime{1}};
}

}  // namespace trb
