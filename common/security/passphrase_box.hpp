// Bytes that a passphrase opens: Argon2id makes the key of it, XSalsa20-Poly1305 locks.
#pragma once

#include <string>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb {

constexpr std::size_t kMinPassphrase = 12;
constexpr std::size_t kPassphraseBoxExtra = 16 + 24 + 16;  ///< salt, nonce, tag

/// A passphrase is without a byte order mark at its begin and a carriage return at its end, which a file of Windows
/// has and nobody types. A box that was made with them is still opened with them.

/// salt + nonce + locked bytes. Errors: bad_value (a short passphrase), io_error (too little memory to stretch it).
Result<Bytes> lock_with_passphrase(BytesView plain, const std::string& passphrase);
/// `what`: names the locked bytes in errors. Errors: malformed (too short for anything), not_permitted (another
/// passphrase, or a byte was changed: it cannot be told which), io_error.
Result<Bytes> open_with_passphrase(BytesView box, const std::string& passphrase, const std::string& what);

}  // namespace trb
