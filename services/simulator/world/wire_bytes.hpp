// What the wire adds between two computers; to a frame: on_wire().
#pragma once

#include <cstdint>

#include "common/base/on_wire.hpp"

namespace trb::world {

constexpr std::uint64_t kConnectBytes = 867;  ///< both greetings, and CURVE's four messages
constexpr std::uint64_t kBeaconBytes = 56;    ///< a beacon's datagram beyond its content: key number, nonce, tag

}  // namespace trb::world
