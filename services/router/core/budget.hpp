// So many in a second, whoever asks: for what costs this node more than it costs who makes it do so.
#pragma once

#include <cstdint>

#include "common/base/time.hpp"

namespace trb::router {

class Budget {
 public:
  explicit Budget(std::uint32_t each_second) : each_second_(each_second), left_(each_second) {}

  /// False if this second's are spent.
  bool take(MonotonicTime now) {
    if (now >= end_) {
      left_ = each_second_;
      end_ = now + std::chrono::seconds(1);
    }
    if (left_ == 0) return false;
    --left_;
    return true;
  }
  /// Of the second of the last take().
  [[nodiscard]] std::uint32_t left() const { return left_; }

 private:
  std::uint32_t each_second_;
  std::uint32_t left_;
  MonotonicTime end_;
};

}  // namespace trb::router
