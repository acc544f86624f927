#include "common/base/ids.hpp"

#include <algorithm>
#include <array>

namespace trb {
namespace {

constexpr bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}
constexpr bool is_upper(char c) {
  return c >= 'A' && c <= 'Z';
}
constexpr bool is_tail(char c) {
  return is_lower(c) || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

/// Every frame's subtype is checked, so each of its characters costs one look-up.
constexpr auto kInWord = [] {
  std::array<bool, 256> out{};
  for (unsigned c = 0; c < out.size(); ++c) out[c] = is_tail(static_cast<char>(c)) || is_upper(static_cast<char>(c));
  return out;
}();

}  // namespace

bool is_valid_id(std::string_view id) {
  return !id.empty() && id.size() <= kMaxIdSize && is_lower(id[0]) && std::all_of(id.begin(), id.end(), is_tail);
}

bool is_valid_word(std::string_view word) {
  return !word.empty() && word.size() <= kMaxIdSize && (is_lower(word[0]) || is_upper(word[0])) &&
         std::all_of(word.begin(), word.end(), [](char c) { return kInWord[static_cast<unsigned char>(c)]; });
}

Status check_id(std::string_view field, std::string_view id) {
  if (is_valid_id(id)) return Done{};
  return fail(Errc::bad_value, std::string(field) + ": '" + std::string(id.substr(0, kMaxIdSize)) + "' is no id",
              "use a lower-case letter, then letters, digits, '_' or '-', 64 at most");
}

}  // namespace trb
