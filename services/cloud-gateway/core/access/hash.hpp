// Secrets that are shown once, and what is kept of them.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "common/base/bytes.hpp"

namespace trb::gateway {

/// So many random bytes. A core has none of its own.
using RandomBytes = std::function<Bytes(std::size_t)>;

constexpr std::size_t kSecretBytes = 32;
constexpr std::size_t kSecretDigits = 2 * kSecretBytes;

/// 256 random bits as 64 hexadecimal digits.
std::string new_secret(const RandomBytes& random);

/// BLAKE2b-256 for one purpose: the hash of a session's id is never that of a token or of an audit record.
Bytes purpose_digest(std::string_view purpose, BytesView bytes);

}  // namespace trb::gateway
