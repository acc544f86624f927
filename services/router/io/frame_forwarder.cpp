#include "services/router/io/frame_forwarder.hpp"

#include "proto/deadline.hpp"
#include "services/router/io/send_errors.hpp"

namespace trb::router {
namespace {

bool any(const Effects& effects) {
  return !effects.list.empty() || !effects.counts.empty();
}

}  // namespace

/// With what is left of its deadline, if it may have waited for this loop; nothing: all of it is left.
std::optional<HeaderView> FrameForwarder::aged(const HeaderView& header, Now now) const {
  const Duration waited = shell_.loop().waited(now.mono);
  const std::uint32_t left = remaining_after(waited, header.type, header.subtype, header.remaining_ms);
  if (left == header.remaining_ms) return std::nullopt;
  HeaderView out = header;
  out.remaining_ms = left;
  return out;
}

void FrameForwarder::from_bus(ConnectionId from, const HeaderView& as_sent, Frame& frame) {
  Effects effects;
  const Now now = read_clocks();
  const auto late = aged(as_sent, now);
  const HeaderView& header = late ? *late : as_sent;
  if (late) stamp_remaining(static_cast<char*>(frame.data()), header.remaining_ms);
  const FrameOrders orders =
      shell_.core().forwarding().from_bus(from, header, static_cast<char*>(frame.data()), frame.size(), now, effects);
  const char direction = orders.way.to == Routing::To::service ? '=' : '>';
  for (unsigned i = 0; i < orders.shown; ++i) to_.tap.show(direction, view_of(frame));
  for (const ConnectionId to : orders.copies) {
    if (to_.bus.send(to, to_frame(view_of(frame))) != SendResult::sent) shell_.count("dropped.queue_full");
  }
  send(from, header, orders, frame, effects);
  if (any(effects)) shell_.carry_out(effects);
  for (const Routing& way : orders.each) send_copy(way, frame);
  if (!orders.each.empty()) report_lost_links();
}

void FrameForwarder::send(ConnectionId from, const HeaderView& header, const FrameOrders& orders, Frame& frame,
                          Effects& effects) {
  const Routing& way = orders.way;
  if (way.to == Routing::To::lane) return to_.lanes.publish(way.link, std::move(frame));
  // A failed send has not changed the frame, nor the header that points into it.
  if (way.to == Routing::To::service) {
    const SendResult result = to_.bus.send(way.connection, std::move(frame));
    if (result != SendResult::sent)
      shell_.core().forwarding().on_unsent(from, header, why_undelivered(result), effects);
  } else if (way.to == Routing::To::peer) {
    const SendResult result = to_.links.send(way.link, orders.outgoing, std::move(frame));
    if (result != SendResult::sent) shell_.core().forwarding().on_unsent(from, header, why_unsent(result), effects);
    if (result == SendResult::unroutable) to_.links.lose(way.link);
  }
}

/// A copy for one of several peers.
void FrameForwarder::send_copy(const Routing& way, const Frame& frame) {
  to_.tap.show('>', view_of(frame));
  if (way.to == Routing::To::lane) return to_.lanes.publish(way.link, to_frame(view_of(frame)));
  const SendResult result = to_.links.send(way.link, to_frame(view_of(frame)));
  if (result == SendResult::unroutable) to_.links.lose(way.link);
  if (result != SendResult::sent) shell_.count("dropped." + std::string(errc_name(why_unsent(result))));
}

void FrameForwarder::from_link(LinkId link, const HeaderView& as_sent, Frame& frame) {
  Effects effects;
  const Now now = read_clocks();
  const auto late = aged(as_sent, now);
  const HeaderView& header = late ? *late : as_sent;
  const FrameOrders orders = shell_.core().forwarding().from_link(link, header, view_of(frame), now, effects);
  to_.proof.keep(orders, now.utc, view_of(frame));
  // Seal and proof are over the bytes as they were sent.
  if (late) stamp_remaining(static_cast<char*>(frame.data()), header.remaining_ms);
  deliver(link, header, frame, orders, effects);
  if (any(effects)) shell_.carry_out(effects);
}

void FrameForwarder::deliver(LinkId link, const HeaderView& header, Frame& frame, const FrameOrders& orders,
                             Effects& effects) {
  for (const ConnectionId to : orders.copies) {
    const SendResult result = deliver_one(link, header, orders.hold, to, to_frame(view_of(frame)));
    if (result != SendResult::sent) shell_.count("dropped.queue_full");
  }
  if (orders.shown > 0) to_.tap.show('<', view_of(frame));
  if (orders.way.to != Routing::To::service) return;
  const SendResult result = deliver_one(link, header, orders.hold, orders.way.connection, std::move(frame));
  // A failed send has not changed the frame, nor the header that points into it.
  if (result != SendResult::sent)
    shell_.core().forwarding().on_undelivered(link, header, why_undelivered(result), effects);
}

SendResult FrameForwarder::deliver_one(LinkId link, const HeaderView& header, bool hold, ConnectionId to,
                                       Frame&& frame) {
  if (!hold) return to_.bus.send_of(header.source, to, std::move(frame));
  to_.held.hold(link, header.sequence, to, std::move(frame));
  return SendResult::sent;
}

void FrameForwarder::from_stranger(BytesView key, const HeaderView& header, const Frame& frame, Effects& effects) {
  const Now now = read_clocks();
  const FrameOrders orders = shell_.core().forwarding().from_stranger(key, header, view_of(frame), now, effects);
  to_.proof.keep(orders, now.utc, view_of(frame));
}

void FrameForwarder::from_lane(LinkId link, Frame& frame) {
  const auto header = decode_frame(view_of(frame));
  if (!header) return shell_.count("refused.lane_malformed");
  Effects effects;
  const Routing decision = shell_.core().forwarding().from_lane(link, *header, effects);
  if (decision.to == Routing::To::service) {
    to_.tap.show('<', view_of(frame));
    const SendResult result = to_.bus.send_of(header->source, decision.connection, std::move(frame));
    const Errc why = why_undelivered(result);
    shell_.count(result == SendResult::sent ? "lane.received" : "dropped." + std::string(errc_name(why)));
  }
  if (any(effects)) shell_.carry_out(effects);
}

void FrameForwarder::report_lost_links() {
  // That an accepted link's connection is gone shows only at the next send.
  while (const auto link = to_.links.take_lost()) {
    Effects effects;
    shell_.core().links().on_ended(*link, LinkEndReason::disconnected, read_clocks(), effects);
    shell_.carry_out(effects);
  }
}

}  // namespace trb::router
