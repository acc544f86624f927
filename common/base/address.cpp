#include "common/base/address.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "common/base/number_text.hpp"

namespace trb {
namespace {

bool is_port(std::string_view digits) {
  return parse_number<std::uint16_t>(digits).value_or(0) != 0;
}

/// An interface name that Linux allows, without characters that would end a line or a word.
bool is_scope(std::string_view name) {
  constexpr std::size_t kMost = 15;  // IFNAMSIZ
  return !name.empty() && name.size() <= kMost && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.' || c == '@';
  });
}

bool is_address(int family, std::string_view text) {
  in6_addr room{};
  // inet_pton stops at a zero byte inside the text.
  return text.find('\0') == std::string_view::npos && inet_pton(family, std::string(text).c_str(), &room) == 1;
}

}  // namespace

bool is_numeric_endpoint(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || !is_port(text.substr(colon + 1))) return false;
  std::string_view host = text.substr(0, colon);
  if (host.size() < 2 || host.front() != '[' || host.back() != ']') return is_address(AF_INET, host);
  host = host.substr(1, host.size() - 2);
  const std::size_t percent = host.find('%');
  if (percent == std::string_view::npos) return is_address(AF_INET6, host);
  return is_scope(host.substr(percent + 1)) && is_address(AF_INET6, host.substr(0, percent));
}

}  // namespace trb
