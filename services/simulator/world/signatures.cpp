// A world's signatures. Ed25519 would take half of a large fleet's time and prove nothing here, where all keys are of
// one process: a keyed BLAKE2b of the same size stands in its place. As with the real one, only who has the secret key
// can sign, and a signature fits one key and one text. Random bytes are a world's own, too. The linker puts these
// functions before libsodium's own (--wrap).
#include <sodium.h>

#include <array>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "services/simulator/world/nonces.hpp"

namespace {

constexpr std::size_t kSignature = 64;
constexpr std::size_t kKey = 32;
using Signature = std::array<unsigned char, kSignature>;

/// What no core knows: it is not to be had from a public key.
constexpr std::array<unsigned char, 32> kWorldSecret{'t', 'h', 'e', ' ', 'w', 'o', 'r', 'l', 'd'};

/// With the key taken in: each signature begins with a copy of it.
crypto_generichash_state keyed() {
  crypto_generichash_state state;
  crypto_generichash_init(&state, kWorldSecret.data(), kWorldSecret.size(), kSignature);
  return state;
}

Signature sign(const unsigned char* public_key, const unsigned char* text, unsigned long long size) {
  static const crypto_generichash_state begun = keyed();
  Signature out{};
  crypto_generichash_state state = begun;
  crypto_generichash_update(&state, public_key, kKey);
  crypto_generichash_update(&state, text, size);
  crypto_generichash_final(&state, out.data(), out.size());
  return out;
}

/// The signatures that were made last, with the key and the text that they sign: to check one of them nothing is
/// computed again. A beacon is checked by all who receive it.
class Made {
 public:
  void remember(const Signature& signature, const unsigned char* key, std::string_view text) {
    if (text.size() > kLongestKept) return;
    Row& row = row_of(signature.data());
    row.signature = signature;
    std::memcpy(row.key.data(), key, kKey);
    row.text = text;
  }
  [[nodiscard]] bool has(const unsigned char* signature, const unsigned char* key, std::string_view text) {
    const Row& row = row_of(signature);
    return !row.text.empty() && std::memcmp(row.signature.data(), signature, kSignature) == 0 &&
           std::memcmp(row.key.data(), key, kKey) == 0 && row.text == text;
  }

 private:
  struct Row {
    Signature signature{};
    std::array<unsigned char, kKey> key{};
    std::string text;
  };
  /// A signature's bytes are as good as random.
  Row& row_of(const unsigned char* signature) { return rows_[(signature[0] | signature[1] << 8U) % kRows]; }

  static constexpr std::size_t kRows = 1024;
  static constexpr std::size_t kLongestKept = 4096;
  std::vector<Row> rows_{kRows};
};
thread_local Made made;

std::string_view view(const unsigned char* text, unsigned long long size) {
  return {reinterpret_cast<const char*>(text), size};
}

/// Of the world that is played: its seed, and how many draws there were.
struct Nonces {
  bool are_drawn = false;
  std::array<std::uint64_t, 4> state{};
};
Nonces nonces;

}  // namespace

void trb::world::draw_nonces_from(std::uint64_t seed) {
  nonces = {true, {seed, 0, 0, 0}};
}

// The linker gives these names.
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" {

int __real_crypto_sign_verify_detached(const unsigned char* signature, const unsigned char* text,
                                       unsigned long long size, const unsigned char* key);

void __real_randombytes_buf(void* out, std::size_t size);

void __wrap_randombytes_buf(void* out, std::size_t size) {
  if (!nonces.are_drawn) return __real_randombytes_buf(out, size);
  std::array<unsigned char, randombytes_SEEDBYTES> from{};
  static_assert(sizeof nonces.state == sizeof from);
  ++nonces.state[1];
  std::memcpy(from.data(), nonces.state.data(), from.size());
  randombytes_buf_deterministic(out, size, from.data());
}

/// libsodium stores the public key after the seed, in the secret key.
int __wrap_crypto_sign_detached(unsigned char* signature, unsigned long long* length, const unsigned char* text,
                                unsigned long long size, const unsigned char* secret) {
  const Signature is = sign(secret + kKey, text, size);
  std::memcpy(signature, is.data(), is.size());
  made.remember(is, secret + kKey, view(text, size));
  if (length != nullptr) *length = is.size();
  return 0;
}

/// One that was not made here may be a real one.
int __wrap_crypto_sign_verify_detached(const unsigned char* signature, const unsigned char* text,
                                       unsigned long long size, const unsigned char* key) {
  if (made.has(signature, key, view(text, size))) return 0;
  const Signature is = sign(key, text, size);
  if (std::memcmp(signature, is.data(), is.size()) == 0) return 0;
  return __real_crypto_sign_verify_detached(signature, text, size, key);
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
