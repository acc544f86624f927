// How much of one node is held, and how much of it is told: what a hostile member says costs the others nothing.
#pragma once

#include <cstddef>

#include "common/base/time.hpp"

namespace trb::gateway {

class NodeBudget {
 public:
  static constexpr std::size_t kMaxHeld = 256U << 10U;
  static constexpr double kToldEachSecond = 32U << 10U;
  static constexpr double kToldAtOnce = 128U << 10U;

  /// Exchanges `before` held bytes for `after`. False: over the bound, nothing has changed.
  bool hold(std::size_t before, std::size_t after);
  /// True: it may be told now, and is counted. A row that is larger than what is left goes, and is paid for later.
  bool tell(std::size_t bytes, MonotonicTime now);
  [[nodiscard]] std::size_t held() const { return held_; }

 private:
  std::size_t held_ = 0;
  double left_ = kToldAtOnce;
  MonotonicTime at_;
};

}  // namespace trb::gateway
