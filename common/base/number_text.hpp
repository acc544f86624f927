#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace trb {

/// The number in a text that consists of digits only (no space, no '+'); nothing if it is not a number or out of T's
/// range.
template <class T>
std::optional<T> parse_number(std::string_view text) {
  T out{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return out;
}

/// The same for hexadecimal digits, without "0x".
template <class T>
std::optional<T> parse_hex_number(std::string_view digits) {
  T out{};
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), out, 16);
  if (problem != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return out;
}

}  // namespace trb
