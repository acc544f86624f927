#include "services/cloud-gateway/core/live/node_budget.hpp"

#include <algorithm>

namespace trb::gateway {

bool NodeBudget::hold(std::size_t before, std::size_t after) {
  const std::size_t held = held_ - std::min(before, held_) + after;
  if (held > kMaxHeld && after > before) return false;
  held_ = held;
  return true;
}

bool NodeBudget::take(std::size_t bytes, MonotonicTime now) {
  left_ = std::min(kPublishedAtOnce, left_ + std::max(0.0, to_seconds(now - at_)) * kPublishedEachSecond);
  at_ = std::max(at_, now);
  if (left_ <= 0) return false;
  left_ -= static_cast<double>(bytes);
  return true;
}

}  // namespace trb::gateway
