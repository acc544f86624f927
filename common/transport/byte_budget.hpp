// How many bytes may wait in queues: libzmq limits only the number of messages, and a message may have 1 MiB.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

#include "common/transport/socket.hpp"

namespace trb {

/// For one destination, or for all together (the `whole` of each). What does not fit is refused, as by a full queue.
/// One thread takes bytes; any thread may give them back.
class ByteBudget {
 public:
  /// `most` bytes may be taken at a time.
  explicit ByteBudget(std::size_t most, std::shared_ptr<ByteBudget> whole = nullptr);
  ByteBudget(const ByteBudget&) = delete;
  ByteBudget& operator=(const ByteBudget&) = delete;

  /// False, and nothing is taken, if this budget would exceed its own limit or take more than is left for all. Heavy
  /// users together leave a newcomer as much as each of them has.
  [[nodiscard]] bool take(std::size_t bytes);
  /// Whether take() would succeed: asked before work is spent on a message that would be refused.
  [[nodiscard]] bool has_room(std::size_t bytes) const;
  void give_back(std::size_t bytes);
  [[nodiscard]] std::size_t used() const { return used_.load(std::memory_order_relaxed); }

 private:
  const std::size_t most_;
  const std::shared_ptr<ByteBudget> whole_;
  std::atomic<std::size_t> used_{0};
};

/// Smaller frames are not counted: the limit on their number (kHighWaterMark) bounds them to 1 MiB a destination, 2 MiB
/// a service. So a control message still passes when pictures have used up the budget, and costs nothing extra.
constexpr std::size_t kCountedFrame = 1024;

/// The same frame with the same bytes; they are given back when its last holder releases it, in any thread: it has been
/// written to its connection, or the connection's queue is gone. They must have been taken before.
Frame count_frame(const std::shared_ptr<ByteBudget>& budget, Frame&& frame);

/// Sends with `put`, called with the frame, if the budget has room; otherwise `full`. An unsent frame stays in `frame`,
/// at the same address, and counts until the frame is gone.
template <class Put>
SendResult send_within(const std::shared_ptr<ByteBudget>& budget, Frame& frame, const Put& put) {
  if (frame.size() >= kCountedFrame) {
    if (!budget->take(frame.size())) return SendResult::full;
    frame = count_frame(budget, std::move(frame));
  }
  return put(std::move(frame));
}

}  // namespace trb
