// Limits one node's stored and published bytes, so that a hostile node costs the others nothing.
#pragma once

#include <cstddef>

#include "common/base/time.hpp"

namespace trb::gateway {

class NodeBudget {
 public:
  static constexpr std::size_t kMaxHeld = 256U << 10U;
  static constexpr double kPublishedEachSecond = 32U << 10U;
  static constexpr double kPublishedAtOnce = 128U << 10U;

  /// Replaces `before` stored bytes by `after`. False: over the bound, nothing changed.
  bool hold(std::size_t before, std::size_t after);
  /// True: publish now; the bytes are counted. A row larger than the rest of the budget passes and delays later ones.
  bool take(std::size_t bytes, MonotonicTime now);
  [[nodiscard]] std::size_t held() const { return held_; }

 private:
  std::size_t held_ = 0;
  double left_ = kPublishedAtOnce;
  MonotonicTime at_;
};

}  // namespace trb::gateway
