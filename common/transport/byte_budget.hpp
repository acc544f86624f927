// How many bytes may wait in queues: libzmq's are bounded in messages alone, and a message may have 1 MiB.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

#include "common/transport/socket.hpp"

namespace trb {

/// Of one destination, or of all together (`whole` of each). What does not fit is refused, as a full queue refuses.
/// Bytes are taken by one thread and given back by any.
class ByteBudget {
 public:
  /// `most` bytes may be taken at a time.
  explicit ByteBudget(std::size_t most, std::shared_ptr<ByteBudget> whole = nullptr);
  ByteBudget(const ByteBudget&) = delete;
  ByteBudget& operator=(const ByteBudget&) = delete;

  /// False, and nothing is taken: this one would have more than its own, or more than is left for all. So those who
  /// take all that they can leave to whoever has taken nothing as much as each of them has.
  [[nodiscard]] bool take(std::size_t bytes);
  /// What take() would say: before work is spent on what would be refused.
  [[nodiscard]] bool has_room(std::size_t bytes) const;
  void give_back(std::size_t bytes);
  [[nodiscard]] std::size_t used() const { return used_.load(std::memory_order_relaxed); }

 private:
  const std::size_t most_;
  const std::shared_ptr<ByteBudget> whole_;
  std::atomic<std::size_t> used_{0};
};

/// Frames below this are not counted: the number that may wait (kHighWaterMark) bounds them, to 1 MiB a destination. So
/// a word of control still finds its way where pictures have used the budget up, and costs nothing more.
constexpr std::size_t kCountedFrame = 1024;

/// The same frame, of the same bytes, which gives them back when the last that holds it has let it go, in whatever
/// thread: it has been written to its connection, or the connection's queue is gone. They must have been taken.
Frame count_frame(const std::shared_ptr<ByteBudget>& budget, Frame&& frame);

/// Sends by `put`, a call with the frame, what the budget has room for; `full` if it has none. What was not sent is in
/// `frame`, at the same address, and counts until the frame is gone.
template <class Put>
SendResult send_within(const std::shared_ptr<ByteBudget>& budget, Frame& frame, const Put& put) {
  if (frame.size() >= kCountedFrame) {
    if (!budget->take(frame.size())) return SendResult::full;
    frame = count_frame(budget, std::move(frame));
  }
  return put(std::move(frame));
}

}  // namespace trb
