// What a router has learned of its authority since it was made: who is out, whose certificate was renewed.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/security/keys.hpp"
#include "proto/bodies/link.hpp"

namespace trb::router {

struct NewsState {
  SignedRecord record;  ///< the newest list; an empty kind for none
  RevocationList list;
  /// Of others, by id: newer than what they say themselves. Handed to them when they come back.
  std::map<std::string, SignedRecord> renewed;
  std::map<Bytes, Certificate, std::less<>> revoked_keys;  ///< link keys that are over, as far as they were met
  bool muted = false;  ///< the own certificate is revoked or has ended: no beacon, no dialling
  std::optional<UtcTime> warned;
};

}  // namespace trb::router
