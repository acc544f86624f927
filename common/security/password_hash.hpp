// How a person's password is kept.
#pragma once

#include <string>

namespace trb {

/// libsodium's crypto_pwhash_str with OPSLIMIT_INTERACTIVE and MEMLIMIT_INTERACTIVE: argon2id, 64 MiB, some 70 ms.
/// Empty: no memory.
std::string hash_password(const std::string& password);

}  // namespace trb
