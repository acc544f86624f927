#include "common/base/fingerprint.hpp"

#include "common/base/hex.hpp"

namespace trb {

std::string to_fingerprint(BytesView digest) {
  std::string out;
  for (const char digit : to_hex(digest)) {
    if (out.size() % 3 == 2) out += ':';
    out += digit >= 'a' ? static_cast<char>(digit - 'a' + 'A') : digit;
  }
  return out;
}

std::optional<std::string> read_fingerprint(std::string_view text) {
  constexpr std::size_t kSize = 32;
  std::string digits(text);
  std::erase(digits, ':');
  const auto bytes = from_hex(digits);
  const std::string out = bytes && bytes->size() == kSize ? to_fingerprint(*bytes) : "";
  const bool fits = !out.empty() && (text.size() == digits.size() || text.size() == out.size());
  return fits ? std::optional(out) : std::nullopt;
}

}  // namespace trb
