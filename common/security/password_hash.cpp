#include "common/security/password_hash.hpp"

#include <sodium.h>

#include "common/security/keys.hpp"

namespace trb {

std::string hash_password(const std::string& password) {
  init_crypto();
  char out[crypto_pwhash_STRBYTES] = {};
  const int failed = crypto_pwhash_str(out, password.data(), password.size(), crypto_pwhash_OPSLIMIT_INTERACTIVE,
                                       crypto_pwhash_MEMLIMIT_INTERACTIVE);
  return failed == 0 ? out : "";
}

}  // namespace trb
