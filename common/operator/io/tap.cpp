#include "common/operator/io/tap.hpp"

#include "common/transport/socket.hpp"

namespace trb::op {

Tap::Tap(Context& context, Loop& loop, const BusAddress& address, TapFilter filter, OnRecord on_record)
    : loop_(loop),
      socket_(Socket::tap_client(context, address.endpoint, address.keys())),
      filter_(std::move(filter)),
      on_record_(std::move(on_record)) {
  loop_.add_socket(
      socket_.handle(), [this] { drain(); }, socket_.unseen());
}

Tap::~Tap() {
  loop_.remove_socket(socket_.handle());
}

void Tap::drain() {
  Frame direction;
  Frame frame;
  for (int i = 0; i < kTurnMessages && socket_.receive(direction); ++i) {
    if (!direction.more() || !socket_.receive(frame)) continue;
    const auto record = read_tap(view_of(direction), view_of(frame), filter_, read_clocks().utc);
    if (record && !on_record_(*record)) return;
  }
}

}  // namespace trb::op
