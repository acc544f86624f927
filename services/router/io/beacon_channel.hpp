// The beacons: encrypted with the fleet's key when sent, decrypted when received.
#pragma once

#include <memory>

#include "common/config/interfaces.hpp"
#include "common/security/beacon_key.hpp"
#include "services/router/io/beacon_socket.hpp"
#include "services/router/io/shell_context.hpp"

namespace trb::router {

class BeaconChannel {
 public:
  BeaconChannel(ShellContext& shell, BeaconKey key, std::uint16_t port);

  /// Opens it on this network, if node.json wants beacons and there is a broadcast address. Errors: io_error.
  Status open(const Resolved& host);
  void close() { socket_.reset(); }
  /// Nothing is sent while it is closed.
  void send(BytesView plain);

  [[nodiscard]] std::uint32_t key_number() const { return key_.number; }
  void set_key(BeaconKey key) { key_ = std::move(key); }

 private:
  void on_datagram(BytesView datagram);

  ShellContext& shell_;
  BeaconKey key_;
  std::uint16_t port_;
  std::unique_ptr<BeaconSocket> socket_;
};

}  // namespace trb::router
