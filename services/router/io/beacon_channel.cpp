#include "services/router/io/beacon_channel.hpp"

namespace trb::router {

BeaconChannel::BeaconChannel(ShellContext& shell, BeaconKey key, std::uint16_t port)
    : shell_(shell), key_(std::move(key)), port_(port) {}

Status BeaconChannel::open(const Resolved& host) {
  if (host.address.empty() || !shell_.core().config().beacon || host.broadcast.empty()) return Done{};
  auto socket = BeaconSocket::open(shell_.loop(), host.address, host.broadcast, port_,
                                   [this](BytesView datagram) { on_datagram(datagram); });
  if (!socket) return socket.error();
  socket_ = std::move(*socket);
  return Done{};
}

void BeaconChannel::send(BytesView plain) {
  if (socket_) socket_->send(seal_beacon(key_, shell_.core().config().authority.id(), plain));
}

void BeaconChannel::on_datagram(BytesView datagram) {
  auto plain = open_beacon(key_, shell_.core().config().authority.id(), datagram);
  Effects effects;
  if (!plain) {
    shell_.core().beacons().refuse(errc_name(plain.error().code), plain.error().what, read_clocks(), effects);
  } else {
    shell_.core().beacons().on_beacon(*plain, read_clocks(), effects);
  }
  shell_.carry_out(effects);
}

}  // namespace trb::router
