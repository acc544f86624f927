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

/// So many bytes in a second: what is made for one who asks is counted when it is made, so it is over by one at most.
class ByteRate {
 public:
  explicit ByteRate(std::uint64_t each_second) : each_second_(each_second) {}

  /// False if this second's are spent.
  bool has_room(MonotonicTime now) {
    if (now >= end_) {
      spent_ = 0;
      end_ = now + std::chrono::seconds(1);
    }
    return spent_ < each_second_;
  }
  void spend(std::uint64_t bytes) { spent_ += bytes; }

 private:
  std::uint64_t each_second_;
  std::uint64_t spent_ = 0;
  MonotonicTime end_;
};

}  // namespace trb::router
