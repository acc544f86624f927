// What the wire adds to a frame between two computers.
#pragma once

#include <cstdint>

namespace trb::world {

/// What ZMTP and CURVE add to a frame: 33 bytes of nonce, tag and name, and the length before them.
constexpr std::uint64_t on_wire(std::uint64_t frame) {
  constexpr std::uint64_t kCurve = 33, kShort = 255;
  return frame + kCurve + (frame + kCurve <= kShort ? 2 : 9);
}
constexpr std::uint64_t kConnectBytes = 867;  ///< both greetings, and CURVE's four messages
constexpr std::uint64_t kBeaconBytes = 56;    ///< a beacon's datagram beyond its content: key number, nonce, tag

}  // namespace trb::world
