// A number of operations per second, whoever requests them: for what costs this node more than it costs the requester.
#pragma once

#include <cstdint>

#include "common/base/time.hpp"

namespace trb::router {

class Budget {
 public:
  explicit Budget(std::uint32_t each_second) : each_second_(each_second), left_(each_second) {}

  /// False if this second's budget is used up.
  bool take(MonotonicTime now) {
    if (now >= end_) {
      left_ = each_second_;
      end_ = now + std::chrono::seconds(1);
    }
    if (left_ == 0) return false;
    --left_;
    return true;
  }
  /// A take() now would be true.
  [[nodiscard]] bool has_left(MonotonicTime now) const { return left_ > 0 || now >= end_; }
  /// What is left of the second of the last take().
  [[nodiscard]] std::uint32_t left() const { return left_; }

 private:
  std::uint32_t each_second_;
  std::uint32_t left_;
  MonotonicTime end_;
};

/// A number of bytes per second. Bytes are counted after they were made, so one answer at most goes over the limit.
class ByteRate {
 public:
  explicit ByteRate(std::uint64_t each_second) : each_second_(each_second) {}

  /// False if this second's bytes are used up.
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
