#include "services/router/io/held_frames.hpp"

#include "services/router/io/send_errors.hpp"

namespace trb::router {

void HeldFrames::hold(LinkId link, std::uint64_t sequence, ConnectionId to, Frame&& frame) {
  held_[link].push_back({sequence, to, std::move(frame)});
}

void HeldFrames::deliver(const DeliverHeld& proven) {
  // Looked up each time: a delivery that fails may end the link.
  for (auto at = held_.find(proven.link); at != held_.end(); at = held_.find(proven.link)) {
    if (at->second.empty() || at->second.front().sequence > proven.last) return;
    Held held = std::move(at->second.front());
    at->second.pop_front();
    deliver(proven.link, std::move(held));
  }
}

void HeldFrames::deliver(LinkId link, Held held) {
  const auto header = decode_frame(view_of(held.frame));
  if (!header) return;
  const SendResult result = bus_.send_of(header->source, held.to, std::move(held.frame));
  if (result == SendResult::sent) return;
  Effects effects;
  shell_.core().forwarding().on_undelivered(link, *header, why_undelivered(result), effects);
  shell_.carry_out(effects);
}

void HeldFrames::give_back(const ReturnHeld& of) {
  const auto at = held_.find(of.link);
  if (at == held_.end()) return;
  const std::deque<Held> held = std::exchange(at->second, {});
  std::vector<HeaderView> headers;
  for (const Held& one : held) {
    if (const auto header = decode_frame(view_of(one.frame))) headers.push_back(*header);
  }
  Effects effects;
  shell_.core().forwarding().on_returned(of, headers, effects);
  shell_.carry_out(effects);
}

}  // namespace trb::router
