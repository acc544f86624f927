#include "common/security/relay_box.hpp"

#include <sodium.h>

#include "common/security/raw.hpp"

namespace trb {
namespace {

static_assert(kRelayBoxOverhead == crypto_box_NONCEBYTES + crypto_box_MACBYTES);

}  // namespace

Bytes relay_key(const LinkKey& own, BytesView other) {
  Bytes key(crypto_box_BEFORENMBYTES, '\0');
  if (other.size() != crypto_box_PUBLICKEYBYTES || own.secret_key.size() != crypto_box_SECRETKEYBYTES) return {};
  if (crypto_box_beforenm(raw(key), raw(other), raw(own.secret_key)) != 0) return {};
  return key;
}

Bytes lock_relayed(BytesView key, BytesView plain) {
  Bytes out = random_bytes(crypto_box_NONCEBYTES);
  out.resize(plain.size() + kRelayBoxOverhead);
  crypto_box_easy_afternm(raw(out) + crypto_box_NONCEBYTES, raw(plain), plain.size(), raw(out), raw(key));
  return out;
}

Result<Bytes> unlock_relayed(BytesView key, BytesView box) {
  if (box.size() < kRelayBoxOverhead) return fail(Errc::malformed, "box: shorter than an empty one");
  Bytes plain(box.size() - kRelayBoxOverhead, '\0');
  const BytesView sealed = box.substr(crypto_box_NONCEBYTES);
  if (key.size() != crypto_box_BEFORENMBYTES ||
      crypto_box_open_easy_afternm(raw(plain), raw(sealed), sealed.size(), raw(box), raw(key)) != 0)
    return fail(Errc::wrong_key, "box: made for another key, or changed on its way");
  return plain;
}

}  // namespace trb
