#include "common/security/beacon_key.hpp"

#include <sodium.h>

#include "common/security/keys.hpp"
#include "common/security/raw.hpp"

namespace trb {
namespace {

constexpr BytesView kMagic = "TRBB";
constexpr std::size_t kHintSize = 4;
constexpr std::size_t kHeaderSize = 4 + 4 + kHintSize;
constexpr std::size_t kSecretSize = 32;
constexpr std::size_t kNonceSize = crypto_secretbox_NONCEBYTES;

Bytes number_bytes(std::uint32_t number) {
  Bytes out;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) out += static_cast<char>(number >> shift);
  return out;
}

}  // namespace

Bytes seal_beacon(const BeaconKey& key, BytesView fleet, BytesView plain) {
  const Bytes nonce = random_bytes(kNonceSize);
  Bytes box(plain.size() + crypto_secretbox_MACBYTES, '\0');
  crypto_secretbox_easy(raw(box), raw(plain), plain.size(), raw(nonce), raw(key.secret));
  return Bytes(kMagic) + number_bytes(key.number) + Bytes(fleet.substr(0, kHintSize)) + nonce + box;
}

Result<Bytes> open_beacon(const BeaconKey& key, BytesView fleet, BytesView datagram) {
  constexpr std::size_t kLeast = kHeaderSize + kNonceSize + crypto_secretbox_MACBYTES;
  if (datagram.size() < kLeast || datagram.substr(0, 4) != kMagic) return fail(Errc::malformed, "no beacon");
  if (datagram.substr(8, kHintSize) != fleet.substr(0, kHintSize))
    return fail(Errc::foreign_fleet, "beacon of another fleet");
  if (datagram.substr(4, 4) != number_bytes(key.number)) {
    return fail(Errc::wrong_key, "beacon under another key number", "sign the older node's request again");
  }
  const BytesView nonce = datagram.substr(kHeaderSize, kNonceSize);
  const BytesView box = datagram.substr(kHeaderSize + kNonceSize);
  Bytes plain(box.size() - crypto_secretbox_MACBYTES, '\0');
  if (crypto_secretbox_open_easy(raw(plain), raw(box), box.size(), raw(nonce), raw(key.secret)) != 0) {
    return fail(Errc::bad_signature, "beacon does not open with the fleet's key");
  }
  return plain;
}

Bytes seal_beacon_key(const BeaconKey& key, BytesView link_key) {
  Bytes sealed(key.secret.size() + crypto_box_SEALBYTES, '\0');
  crypto_box_seal(raw(sealed), raw(key.secret), key.secret.size(), raw(link_key));
  return sealed;
}

Result<BeaconKey> open_sealed_beacon_key(std::uint32_t number, BytesView box, const LinkKey& link) {
  BeaconKey key{number, Bytes(kSecretSize, '\0')};
  if (box.size() != kSecretSize + crypto_box_SEALBYTES ||
      crypto_box_seal_open(raw(key.secret), raw(box), box.size(), raw(link.public_key), raw(link.secret_key)) != 0) {
    return fail(Errc::wrong_key, "the beacon key was sealed for another node", "run trb fleet sign again");
  }
  return key;
}

BeaconKey derive_beacon_key(BytesView authority_secret, std::uint32_t number) {
  const Bytes label = "talkrobots beacon key " + std::to_string(number);
  BeaconKey key{number, Bytes(kSecretSize, '\0')};
  crypto_generichash(raw(key.secret), key.secret.size(), raw(label), label.size(), raw(authority_secret),
                     authority_secret.size());
  return key;
}

}  // namespace trb
