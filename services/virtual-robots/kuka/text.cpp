#include "services/virtual-robots/kuka/text.hpp"

#include <cstdio>
#include <cstdlib>

namespace trb::virtual_robots::kuka {
namespace {

std::size_t escape_length(std::string_view text) {
  if (text.front() != '\\' || text.size() < 2) return 1;
  return text[1] == 'x' && text.size() >= 4 ? 4 : 2;
}

}  // namespace

std::string escape_field(std::string_view text) {
  std::string out;
  for (const char c : text) {
    char hex[5];
    std::snprintf(hex, sizeof hex, "\\x%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    const bool plain = c >= ' ' && c <= '~' && c != '"' && c != '\\';
    out += plain       ? std::string(1, c)
           : c == '\\' ? "\\\\"
           : c == '"'  ? "\\q"
           : c == '\n' ? "\\n"
           : c == '\r' ? "\\r"
                       : hex;
  }
  return out;
}

std::string unescape_field(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = escape_length(text);
    const char kind = length > 1 ? text[1] : '\0';
    if (length == 4) {
      out += static_cast<char>(std::strtol(std::string(text.substr(2, 2)).c_str(), nullptr, 16));
    } else if (length == 2) {
      out += kind == 'q' ? '"' : kind == 'n' ? '\n' : kind == 'r' ? '\r' : kind;
    } else {
      out += text.front();
    }
    text.remove_prefix(length);
  }
  return out;
}

std::size_t whole_escapes(std::string_view escaped, std::size_t most) {
  std::size_t taken = 0;
  while (taken < escaped.size()) {
    const std::size_t next = escape_length(escaped.substr(taken));
    if (taken + next > most) break;
    taken += next;
  }
  return taken;
}

}  // namespace trb::virtual_robots::kuka
