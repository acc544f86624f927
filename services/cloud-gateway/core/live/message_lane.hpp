// Messages that pass the router, for clients that watch. The lane is lossy: the newest are kept once for all clients,
// and a late client receives the count of those it missed.
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
  /// Number of all messages so far.
  [[nodiscard]] std::uint64_t head() const { return head_; }
  /// The messages after number `from`, up to `most` bytes in all.
  [[nodiscard]] Taken take(std::uint64_t from, std::size_t most) const;

 private:
  std::deque<SharedBytes> messages_;
  std::size_t size_ = 0;
  std::uint64_t head_ = 0;
};

}  // namespace trb::gateway
