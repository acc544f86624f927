// What waits for one receiver that many send to: a service of the node, a link by which this node relays.
#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include "services/router/io/shell_context.hpp"
#include "services/router/io/waiting_frames.hpp"

namespace trb::router {

/// The receiver's bytes are bounded, and no peer takes the others' places.
class SharedQueue {
 public:
  /// What peers' frames may take together, of all that may wait.
  SharedQueue(std::shared_ptr<ByteBudget> budget, std::size_t bytes_of_peers, std::size_t frames_of_peers)
      : budget_(std::move(budget)), of_peers_(bytes_of_peers, frames_of_peers) {}

  /// For this node's own frames.
  [[nodiscard]] bool has_room(std::size_t bytes) const { return budget_->has_room(bytes); }
  /// False: the peer has its share of what waits.
  [[nodiscard]] bool has_share(std::string_view peer, std::size_t bytes) { return of_peers_.has_room(peer, bytes); }

  /// Sends by `put`, called with the frame. `peer`: whose frame it is; empty: this node's own.
  template <class Put>
  SendResult send(std::string_view peer, Frame& frame, const Put& put) {
    if (peer.empty()) return send_within(budget_, frame, put);
    if (!has_share(peer, frame.size())) return SendResult::full;
    return send_within(budget_, frame, [&](Frame&& one) { return of_peers_.send(peer, one, put); });
  }

 private:
  std::shared_ptr<ByteBudget> budget_;
  WaitingFrames of_peers_;
};

/// Of a link: what this node relays leaves half of it to what it says itself.
inline std::unique_ptr<SharedQueue> new_link_queue(const ShellContext& shell) {
  return std::make_unique<SharedQueue>(shell.new_budget(), ShellContext::kDestinationBytes / 2, kHighWaterMark / 2);
}

}  // namespace trb::router
