#include "services/cloud-gateway/core/live/message_lane.hpp"

#include <algorithm>

namespace trb::gateway {

void MessageLane::add(Bytes message) {
  size_ += message.size();
  ++head_;
  messages_.push_back(std::make_shared<const Bytes>(std::move(message)));
  while (size_ > kMaxBytes || messages_.size() > kMaxMessages) {
    size_ -= messages_.front()->size();
    messages_.pop_front();
  }
}

MessageLane::Taken MessageLane::take(std::uint64_t from, std::size_t most) const {
  Taken out;
  const std::uint64_t behind = head_ - std::min(from, head_);
  for (auto at = messages_.rbegin(); at != messages_.rend(); ++at) {
    const std::size_t size = (*at)->size();
    if (out.messages.size() == std::min<std::uint64_t>(behind, kMaxAtOnce) || out.size + size > most) break;
    out.messages.push_back(*at);
    out.size += size;
  }
  std::reverse(out.messages.begin(), out.messages.end());
  out.left_out = behind - out.messages.size();
  return out;
}

}  // namespace trb::gateway
