#include "common/security/seeded_keys.hpp"

#include <sodium.h>

#include "common/security/raw.hpp"

namespace trb {
namespace {

Bytes seed_bytes(std::string_view purpose, std::uint64_t seed) {
  return purpose_digest(purpose, std::to_string(seed));
}

}  // namespace

SigningKey seeded_signing_key(std::uint64_t seed) {
  SigningKey key{Bytes(crypto_sign_PUBLICKEYBYTES, '\0'), Bytes(crypto_sign_SECRETKEYBYTES, '\0')};
  const Bytes from = seed_bytes("simulated signing key", seed);
  crypto_sign_seed_keypair(raw(key.public_key), raw(key.secret_key), raw(from));
  return key;
}

LinkKey seeded_link_key(std::uint64_t seed) {
  LinkKey key{Bytes(crypto_box_PUBLICKEYBYTES, '\0'), Bytes(crypto_box_SECRETKEYBYTES, '\0')};
  const Bytes from = seed_bytes("simulated link key", seed);
  crypto_box_seed_keypair(raw(key.public_key), raw(key.secret_key), raw(from));
  return key;
}

}  // namespace trb
