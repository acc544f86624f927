// Actions that may fail, one after the other.
#pragma once

#include "common/base/result.hpp"

namespace trb::gateway {

/// Calls each step until one fails; the error is that one's.
template <class... Actions>
Status in_order(const Actions&... steps) {
  Status out = Done{};
  static_cast<void>(((out = steps()).ok() && ...));
  return out;
}

}  // namespace trb::gateway
