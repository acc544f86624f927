#include "common/security/join_code.hpp"

#include <arpa/inet.h>

#include <array>
#include <optional>

#include "common/base/address.hpp"
#include "common/base/number_text.hpp"
#include "common/security/keys.hpp"

namespace trb {
namespace {

constexpr std::string_view kAlphabet = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";
constexpr std::size_t kDigits = 4;  ///< of a group, before its check character
constexpr std::size_t kGroup = kDigits + 1;
constexpr std::size_t kKey = 32;
constexpr std::size_t kSum = 2;  ///< bytes of a digest over all: two wrong characters in a group may cancel out
constexpr unsigned kVersion = 1;

constexpr std::size_t size_of(std::size_t host) {
  return 1 + kJoinSecret + kKey + host + 2 + kSum;
}
constexpr std::size_t groups_of(std::size_t host) {
  return (size_of(host) * 8 + kDigits * 5 - 1) / (kDigits * 5);
}
constexpr std::size_t kV4 = 4;
constexpr std::size_t kV6 = 16;

/// A product in the field of 32 elements (x^5 + x^2 + 1).
constexpr unsigned product(unsigned a, unsigned b) {
  unsigned out = 0;
  for (; b != 0; b >>= 1U) {
    if ((b & 1U) != 0) out ^= a;
    a = (a & 16U) != 0 ? (a << 1U) ^ 37U : a << 1U;
  }
  return out;
}

/// Another one for each single wrong character, for two neighbours in each other's place, and for the same group at
/// another place.
unsigned check_of(const std::array<unsigned, kDigits>& digits, std::size_t index) {
  unsigned out = static_cast<unsigned>(index % 32);
  unsigned weight = 2;
  for (const unsigned digit : digits) {
    out ^= product(digit, weight);
    weight = product(weight, 2);
  }
  return out;
}

std::optional<unsigned> digit_of(char letter) {
  if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  if (letter == 'O') letter = '0';
  if (letter == 'I' || letter == 'L') letter = '1';
  const auto at = kAlphabet.find(letter);
  if (at == std::string_view::npos) return std::nullopt;
  return static_cast<unsigned>(at);
}

/// Five bits of the bytes; behind their end zeros.
unsigned bits_at(BytesView bytes, std::size_t bit) {
  unsigned out = 0;
  for (std::size_t i = bit; i < bit + 5; ++i) {
    const unsigned byte = i / 8 < bytes.size() ? static_cast<unsigned char>(bytes[i / 8]) : 0U;
    out = (out << 1U) | ((byte >> (7 - i % 8)) & 1U);
  }
  return out;
}

std::string in_groups(BytesView bytes) {
  std::string out;
  const std::size_t groups = (bytes.size() * 8 + kDigits * 5 - 1) / (kDigits * 5);
  for (std::size_t group = 0; group < groups; ++group) {
    if (group > 0) out += '-';
    std::array<unsigned, kDigits> digits{};
    for (std::size_t i = 0; i < kDigits; ++i) digits[i] = bits_at(bytes, (group * kDigits + i) * 5);
    for (const unsigned digit : digits) out += kAlphabet[digit];
    out += kAlphabet[check_of(digits, group)];
  }
  return out;
}

Error mistyped(std::size_t group, std::string_view word) {
  return fail(Errc::malformed,
              "CODE: group " + std::to_string(group + 1) + " ('" + std::string(word) + "') is mistyped",
              "type that group again");
}

/// The characters alone; each group is checked by itself.
Result<std::string> letters_of(std::string_view text) {
  std::string out;
  for (const char letter : text) {
    if (letter == '-' || letter == ' ' || letter == '\n' || letter == '\r' || letter == '\t') continue;
    out += letter;
  }
  const std::size_t groups = (out.size() + kGroup - 1) / kGroup;
  if (out.size() % kGroup == 0 && (groups == groups_of(kV4) || groups == groups_of(kV6))) return out;
  return fail(Errc::malformed,
              "CODE: has " + std::to_string(out.size()) + " characters, " + std::to_string(groups_of(kV4) * kGroup) +
                  " are wanted (" + std::to_string(groups_of(kV6) * kGroup) + " with an IPv6 address)",
              "type every group of trb fleet invite, five characters each");
}

Result<Bytes> bytes_of(std::string_view letters) {
  Bytes out(letters.size() / kGroup * kDigits * 5 / 8, '\0');
  std::size_t bit = 0;
  for (std::size_t group = 0; group * kGroup < letters.size(); ++group) {
    const std::string_view word = letters.substr(group * kGroup, kGroup);
    std::array<unsigned, kDigits> digits{};
    const auto check = digit_of(word[kDigits]);
    for (std::size_t i = 0; i < kDigits; ++i) {
      const auto digit = digit_of(word[i]);
      if (!digit) return mistyped(group, word);
      digits[i] = *digit;
      for (unsigned one = 5; one-- > 0; ++bit) {
        if (bit / 8 < out.size() && ((*digit >> one) & 1U) != 0) {
          out[bit / 8] = static_cast<char>(static_cast<unsigned char>(out[bit / 8]) | (128U >> (bit % 8)));
        }
      }
    }
    if (!check || *check != check_of(digits, group)) return mistyped(group, word);
  }
  return out;
}

Bytes sum_of(BytesView bytes) {
  return purpose_digest("join code", bytes).substr(0, kSum);
}

/// The address as bytes: the host's, then the port's. Empty: not numeric.
Bytes packed_address(const std::string& address) {
  if (!is_numeric_endpoint(address)) return {};
  const auto colon = address.rfind(':');
  const auto port = parse_number<std::uint16_t>(std::string_view(address).substr(colon + 1));
  const bool v6 = address.front() == '[';
  const std::string host = v6 ? address.substr(1, colon - 2) : address.substr(0, colon);
  Bytes out(v6 ? kV6 : kV4, '\0');
  if (!port || ::inet_pton(v6 ? AF_INET6 : AF_INET, host.c_str(), out.data()) != 1) return {};
  out += static_cast<char>(*port >> 8U);
  out += static_cast<char>(*port & 255U);
  return out;
}

std::string address_text(BytesView packed) {
  const bool v6 = packed.size() == kV6 + 2;
  char host[INET6_ADDRSTRLEN] = "";
  ::inet_ntop(v6 ? AF_INET6 : AF_INET, packed.data(), host, sizeof host);
  const auto high = static_cast<unsigned char>(packed[packed.size() - 2]);
  const auto low = static_cast<unsigned char>(packed[packed.size() - 1]);
  const std::string port = std::to_string(high * 256U + low);
  return v6 ? "[" + std::string(host) + "]:" + port : std::string(host) + ":" + port;
}

}  // namespace

Result<std::string> to_text(const JoinCode& code) {
  const Bytes address = packed_address(code.door);
  if (address.empty()) {
    return fail(Errc::bad_value, "the cloud node's address '" + code.door + "' is not numeric, or has a scope",
                "name one that the new node can dial: --at 10.0.0.1:45000");
  }
  Bytes bytes(1, static_cast<char>(kVersion * 2 + (code.role == Role::cloud ? 1 : 0)));
  bytes += code.secret + code.door_key + address;
  return in_groups(bytes + sum_of(bytes));
}

Result<JoinCode> read_join_code(std::string_view text) {
  const auto letters = letters_of(text);
  if (!letters) return letters.error();
  auto bytes = bytes_of(*letters);
  if (!bytes) return bytes.error();
  const std::size_t host = letters->size() / kGroup == groups_of(kV4) ? kV4 : kV6;
  const Bytes sum = bytes->substr(size_of(host) - kSum, kSum);
  const BytesView body = BytesView(*bytes).substr(0, size_of(host) - kSum);
  if (sum != sum_of(body)) {
    return fail(Errc::malformed, "CODE: some group is mistyped, or belongs to another code",
                "compare it with what trb fleet invite shows, group by group");
  }
  const auto head = static_cast<unsigned char>(body[0]);
  if (head / 2 != kVersion) {
    return fail(Errc::version_mismatch, "CODE: made by another version of trb", "install the same version on both");
  }
  JoinCode code;
  code.role = head % 2 == 1 ? Role::cloud : Role::robot;
  code.secret = Bytes(body.substr(1, kJoinSecret));
  code.door_key = Bytes(body.substr(1 + kJoinSecret, kKey));
  code.door = address_text(body.substr(1 + kJoinSecret + kKey));
  return code;
}

}  // namespace trb
