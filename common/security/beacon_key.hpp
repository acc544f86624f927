// The fleet's beacon key: numbered, symmetric, rotated; and the datagram that it protects.
#pragma once

#include <cstdint>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb {

struct BeaconKey {
  std::uint32_t number = 0;
  Bytes secret;  ///< 32 bytes
};

/// magic "TRBB", key number, fleet hint (4 bytes), nonce (24), XSalsa20-Poly1305 box.
Bytes seal_beacon(const BeaconKey& key, BytesView fleet, BytesView plain);

/// Errors: malformed (no beacon at all), foreign_fleet (another fleet's hint), wrong_key (another key number),
/// bad_signature (the box does not open).
Result<Bytes> open_beacon(const BeaconKey& key, BytesView fleet, BytesView datagram);

}  // namespace trb
