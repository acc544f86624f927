// The fleet's beacon key: numbered, symmetric, rotated; and the datagram that it protects.
#pragma once

#include <cstdint>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb {

struct LinkKey;

struct BeaconKey {
  std::uint32_t number = 0;
  Bytes secret;  ///< 32 bytes
};

/// magic "TRBB", key number, fleet hint (4 bytes), nonce (24), XSalsa20-Poly1305 box.
Bytes seal_beacon(const BeaconKey& key, BytesView fleet, BytesView plain);

/// Errors: malformed (not a beacon), foreign_fleet (another fleet's hint), wrong_key (another key number),
/// bad_signature (the box does not open).
Result<Bytes> open_beacon(const BeaconKey& key, BytesView fleet, BytesView datagram);

/// The key in a sealed box (80 bytes) that only the holder of one link key opens.
Bytes seal_beacon_key(const BeaconKey& key, BytesView link_key);
/// Errors: wrong_key if the box was made for another link key.
Result<BeaconKey> open_sealed_beacon_key(std::uint32_t number, BytesView box, const LinkKey& link);

/// The authority's beacon key of that number, derived from its signing key: a rotation stores no secret, and a number
/// always has the same key. Keys of other numbers reveal nothing about it.
BeaconKey derive_beacon_key(BytesView authority_secret, std::uint32_t number);

}  // namespace trb
