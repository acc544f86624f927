// Whose frames wait for one receiver, a service of the node or a link: no peer may take the others' places in its
// queue.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "common/transport/byte_budget.hpp"

namespace trb::router {

/// libzmq does not tell how many frames wait, but it releases each once it is on its way, in the order of the queue. So
/// every few frames carry a mark: the frames before a mark that was released are gone. The rest is the loop's own
/// count.
class WaitingFrames {
 public:
  /// Half of what libzmq takes: it learns of frames that are gone in steps of half its limit.
  static constexpr std::size_t kMost = kBusHighWaterMark / 2;
  static constexpr std::size_t kEach = 32;  ///< small frames, and one has a mark; larger ones all have

  explicit WaitingFrames(std::size_t bytes, std::size_t frames = kMost) : most_bytes_(bytes), most_frames_(frames) {}

  /// Nobody may have more waiting than is left for the others, in frames and in bytes (of frames of kCountedFrame).
  [[nodiscard]] bool has_room(std::string_view peer, std::size_t bytes);
  /// Sends that peer's frame with `put`, called with the frame. Unless the result is `sent`, `frame` is as it was.
  /// `peer` may point into the frame: it is not read once that is sent.
  template <class Put>
  SendResult send(std::string_view peer, Frame& frame, const Put& put) {
    const std::size_t bytes = counted(frame.size());
    const Loads::iterator of = load_of(peer);
    Mark* mark = bytes > 0 || unmarked_ + 1 == kEach ? add_mark(frame) : nullptr;
    const SendResult result = put(std::move(frame));
    if (result == SendResult::sent) {
      note_sent(of, bytes, mark != nullptr);
    } else if (mark != nullptr) {
      remove_mark(frame, *mark);
    }
    return result;
  }
  /// How many of all peers wait, or could: up to kEach more than there are.
  [[nodiscard]] std::size_t count();

 private:
  struct Load {
    std::size_t frames = 0;
    std::size_t bytes = 0;
  };
  using Loads = std::map<std::string, Load, std::less<>>;
  struct Waiting {
    Loads::iterator of;
    std::size_t bytes;
  };
  /// The number of the last frame that is known to be gone; set by libzmq's thread.
  using Gone = std::atomic<std::uint64_t>;
  struct Mark {
    Frame frame;
    std::shared_ptr<Gone> gone;  ///< nullptr: the frame was not sent
    std::uint64_t number;
  };

  static constexpr std::size_t kMostKept = 1024;  ///< peers; of more, those of whom nothing waits are forgotten

  static std::size_t counted(std::size_t size) { return size >= kCountedFrame ? size : 0; }
  static void let_go(void* data, void* mark) noexcept;
  Mark* add_mark(Frame& frame);
  static void remove_mark(Frame& frame, Mark& mark);
  Loads::iterator load_of(std::string_view peer);
  void note_sent(Loads::iterator of, std::size_t bytes, bool has_mark);
  void drop_gone();

  const std::size_t most_bytes_;
  const std::size_t most_frames_;
  std::shared_ptr<Gone> gone_ = std::make_shared<Gone>(0);
  std::uint64_t sent_ = 0;       ///< the number of the last one
  std::size_t unmarked_ = 0;     ///< since the last mark
  std::deque<Waiting> waiting_;  ///< numbers up to sent_
  Loads loads_;
  std::size_t bytes_ = 0;
};

}  // namespace trb::router
