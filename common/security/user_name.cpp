#include "common/security/user_name.hpp"

#include <algorithm>

namespace trb {
namespace {

bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}

}  // namespace

bool is_valid_user_name(std::string_view name) {
  const auto fits = [](char c) { return is_lower(c) || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-'; };
  return !name.empty() && name.size() <= kMaxUserName && is_lower(name.front()) && std::ranges::all_of(name, fits);
}

}  // namespace trb
