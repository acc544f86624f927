// The UDP socket of the beacons: sends broadcasts, receives anything.
#pragma once

#include <functional>
#include <string>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/transport/loop.hpp"

namespace trb::router {

class BeaconSocket {
 public:
  /// Listens on broadcast:port and on every address of the machine that a broadcast may be addressed to.
  static Result<std::unique_ptr<BeaconSocket>> open(Loop& loop, const std::string& address,
                                                    const std::string& broadcast, std::uint16_t port,
                                                    std::function<void(BytesView)> on_datagram);
  ~BeaconSocket();
  BeaconSocket(const BeaconSocket&) = delete;
  BeaconSocket& operator=(const BeaconSocket&) = delete;

  /// Best effort: a beacon is a hint.
  void send(BytesView datagram);

 private:
  BeaconSocket(Loop& loop, int in, int out, std::string broadcast, std::uint16_t port,
               std::function<void(BytesView)> handler);
  void drain();
  Loop& loop_;
  int in_;
  int out_;
  std::string broadcast_;
  std::uint16_t port_;
  std::function<void(BytesView)> on_datagram_;
};

}  // namespace trb::router
