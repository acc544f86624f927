// Secrets that are shown once, and the hashes that are kept of them.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "common/base/bytes.hpp"

namespace trb::gateway {

/// Returns this many random bytes. A core has no source of them.
using RandomBytes = std::function<Bytes(std::size_t)>;

constexpr std::size_t kSecretBytes = 32;
constexpr std::size_t kSecretDigits = 2 * kSecretBytes;

/// 256 random bits as 64 hexadecimal digits.
std::string new_secret(const RandomBytes& random);

}  // namespace trb::gateway
