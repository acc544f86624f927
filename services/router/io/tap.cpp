#include "services/router/io/tap.hpp"

namespace trb::router {

Status Tap::open(const std::string& endpoint, const CurveKeys* curve) {
  auto made = Socket::tap_server(shell_.zmq(), endpoint, curve);
  if (!made) return made.error();
  socket_ = std::move(*made);
  shell_.loop().add_socket(
      socket_->handle(), [this] { drain(); }, socket_->unseen());
  return Done{};
}

void Tap::send(char direction, BytesView frame) {
  Frame copy = to_frame(frame);
  const SendResult result = send_within(budget_, copy, [&](Frame&& one) {
    socket_->send(to_frame(std::string(1, direction)), true);
    return socket_->send(std::move(one));
  });
  if (result != SendResult::sent) shell_.count("dropped.tap_full");
}

void Tap::drain() {
  Frame frame;
  while (socket_->receive(frame)) {
    const BytesView subscription = view_of(frame);
    if (subscription.empty()) continue;
    if (subscription[0] == 1) {
      ++listeners_;
      if (on_listener_) on_listener_(subscriber_fd(frame));
    } else if (listeners_ > 0) {
      --listeners_;
    }
  }
}

}  // namespace trb::router
