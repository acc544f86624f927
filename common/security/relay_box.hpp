// A message through a relay is encrypted for its target: the relay sees only sender, target, time and size.
#pragma once

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/security/keys.hpp"

namespace trb {

/// The key that two nodes share: X25519 of one's secret link key and the other's public one. 32 bytes; empty if `other`
/// is not a key. Both sides get the same.
Bytes relay_key(const LinkKey& own, BytesView other);

/// A random nonce (24 bytes) and an XSalsa20-Poly1305 box.
Bytes lock_relayed(BytesView key, BytesView plain);
/// Errors: malformed (too short for a box), wrong_key (it does not open with this key, or was changed).
Result<Bytes> unlock_relayed(BytesView key, BytesView box);

/// How much larger a box is than its content.
constexpr std::size_t kRelayBoxOverhead = 24 + 16;

}  // namespace trb
