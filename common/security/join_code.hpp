// The code of `trb fleet invite`, as a person reads it out and types it: groups of five characters, each with a check
// character of its own, so that a mistyped group is named.
#pragma once

#include <string>
#include <string_view>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "proto/bodies/signed.hpp"

namespace trb {

constexpr std::size_t kJoinSecret = 16;  ///< bytes: nobody finds it by trying, with whatever he has recorded

struct JoinCode {
  Bytes secret;      ///< kJoinSecret bytes
  Role role{};       ///< of the invited node
  Bytes door_key;    ///< CURVE public key of the cloud node that keeps the invitation
  std::string door;  ///< its address, numeric, HOST:PORT
  bool operator==(const JoinCode&) const = default;
};

/// Groups with hyphens between them: 23 for an IPv4 address, 28 for an IPv6 one. Crockford's base 32: no I, L, O, U.
/// Errors: bad_value: the address is not numeric, or has a scope.
Result<std::string> to_text(const JoinCode& code);

/// Reads it with or without hyphens and spaces, in upper or lower case; o counts as 0, i and l as 1. Errors: malformed,
/// naming the first group that is mistyped; version_mismatch: another version made it.
Result<JoinCode> read_join_code(std::string_view text);

}  // namespace trb
