// What passes the router, for who watches. It is lossy: the newest are kept once for all, and who comes late is told
// how many it has missed.
#pragma once

#include <deque>
#include <vector>

#include "services/cloud-gateway/core/live/row.hpp"

namespace trb::gateway {

class MessageLane {
 public:
  static constexpr std::size_t kMaxBytes = 1U << 20U;
  static constexpr std::size_t kMaxMessages = 1000;
  static constexpr std::size_t kMaxAtOnce = 200;

  struct Taken {
    std::vector<SharedBytes> messages;  ///< the newest, in their order
    std::size_t size = 0;
    std::uint64_t left_out = 0;
  };

  void add(Bytes message);
  /// How many there were.
  [[nodiscard]] std::uint64_t head() const { return head_; }
  /// Those behind number `from`, of `most` bytes together.
  [[nodiscard]] Taken take(std::uint64_t from, std::size_t most) const;

 private:
  std::deque<SharedBytes> messages_;
  std::size_t size_ = 0;
  std::uint64_t head_ = 0;
};

}  // namespace trb::gateway
