#include "common/base/ids.hpp"

#include <algorithm>

namespace trb {
namespace {

bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}
bool is_upper(char c) {
  return c >= 'A' && c <= 'Z';
}
bool is_tail(char c) {
  return is_lower(c) || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

}  // namespace

bool is_valid_id(std::string_view id) {
  return !id.empty() && id.size() <= kMaxIdSize && is_lower(id[0]) && std::all_of(id.begin(), id.end(), is_tail);
}

bool is_valid_word(std::string_view word) {
  return !word.empty() && word.size() <= kMaxIdSize && (is_lower(word[0]) || is_upper(word[0])) &&
         std::all_of(word.begin(), word.end(), [](char c) { return is_tail(c) || is_upper(c); });
}

Status check_id(std::string_view field, std::string_view id) {
  if (is_valid_id(id)) return Done{};
  return fail(Errc::bad_value, std::string(field) + ": '" + std::string(id.substr(0, kMaxIdSize)) + "' is no id",
              "use a lower-case letter, then letters, digits, '_' or '-', 64 at most");
}

}  // namespace trb
