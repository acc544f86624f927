#include "common/security/passphrase_box.hpp"

#include <sodium.h>

#include "common/security/keys.hpp"
#include "common/security/raw.hpp"

namespace trb {
namespace {

constexpr std::size_t kSaltBytes = crypto_pwhash_SALTBYTES;
constexpr std::size_t kBoxHead = kSaltBytes + crypto_secretbox_NONCEBYTES;
static_assert(kBoxHead + crypto_secretbox_MACBYTES == kPassphraseBoxExtra);

/// As a person types it.
std::string plain_of(const std::string& passphrase) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  std::string_view out = passphrase;
  if (out.starts_with(kMark)) out.remove_prefix(kMark.size());
  while (out.ends_with('\r')) out.remove_suffix(1);
  return std::string(out);
}

Result<Bytes> stretch(const std::string& passphrase, BytesView salt) {
  Bytes key(crypto_secretbox_KEYBYTES, '\0');
  if (crypto_pwhash(raw(key), key.size(), passphrase.data(), passphrase.size(), raw(salt),
                    crypto_pwhash_OPSLIMIT_MODERATE, crypto_pwhash_MEMLIMIT_INTERACTIVE,
                    crypto_pwhash_ALG_ARGON2ID13) != 0) {
    return fail(Errc::io_error, "not enough memory to stretch the passphrase");
  }
  return key;
}

Result<Bytes> open_with(BytesView box, const std::string& passphrase, const std::string& what) {
  const BytesView salt = box.substr(0, kSaltBytes);
  const BytesView nonce = box.substr(kSaltBytes, crypto_secretbox_NONCEBYTES);
  const BytesView locked = box.substr(kBoxHead);
  const auto key = stretch(passphrase, salt);
  if (!key) return key.error();
  Bytes plain(locked.size() - crypto_secretbox_MACBYTES, '\0');
  if (crypto_secretbox_open_easy(raw(plain), raw(locked), locked.size(), raw(nonce), raw(*key)) != 0) {
    return fail(Errc::not_permitted, what + ": the passphrase is wrong, or the file is damaged", "try again");
  }
  return plain;
}

}  // namespace

Result<Bytes> lock_with_passphrase(BytesView plain, const std::string& given) {
  const std::string passphrase = plain_of(given);
  if (passphrase.size() < kMinPassphrase) {
    return fail(Errc::bad_value, "passphrase: under " + std::to_string(kMinPassphrase) + " characters",
                "take a longer one");
  }
  const Bytes salt = random_bytes(kSaltBytes);
  const auto key = stretch(passphrase, salt);
  if (!key) return key.error();
  const Bytes nonce = random_bytes(crypto_secretbox_NONCEBYTES);
  Bytes box(plain.size() + crypto_secretbox_MACBYTES, '\0');
  crypto_secretbox_easy(raw(box), raw(plain), plain.size(), raw(nonce), raw(*key));
  return salt + nonce + box;
}

Result<Bytes> open_with_passphrase(BytesView box, const std::string& passphrase, const std::string& what) {
  if (box.size() < kPassphraseBoxExtra) return fail(Errc::malformed, what + ": damaged: too short");
  const std::string plain = plain_of(passphrase);
  auto opened = open_with(box, plain, what);
  if (opened || opened.error().code != Errc::not_permitted || plain == passphrase) return opened;
  return open_with(box, passphrase, what);  // an earlier version took them for a part of it
}

}  // namespace trb
