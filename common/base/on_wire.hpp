// What ZMTP and CURVE add to a frame on the wire.
#pragma once

#include <cstdint>

namespace trb {

/// The bytes of a frame of this size between two computers: 33 bytes of nonce, tag and name, and the length before
/// them.
constexpr std::uint64_t on_wire(std::uint64_t frame) {
  constexpr std::uint64_t kCurve = 33, kShort = 255;
  return frame + kCurve + (frame + kCurve <= kShort ? 2 : 9);
}

}  // namespace trb
