#include "services/cloud-gateway/core/access/hash.hpp"

#include "common/base/hex.hpp"
#include "common/security/keys.hpp"

namespace trb::gateway {

std::string new_secret(const RandomBytes& random) {
  return to_hex(random(kSecretBytes));
}

Bytes purpose_digest(std::string_view purpose, BytesView bytes) {
  Bytes all = "talkrobots";
  all += '\0';
  all += purpose;
  all += '\0';
  all += bytes;
  return digest(all);
}

}  // namespace trb::gateway
