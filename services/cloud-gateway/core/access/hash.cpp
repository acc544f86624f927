#include "services/cloud-gateway/core/access/hash.hpp"

#include "common/base/hex.hpp"

namespace trb::gateway {

std::string new_secret(const RandomBytes& random) {
  return to_hex(random(kSecretBytes));
}

}  // namespace trb::gateway
