#include "common/base/printable.hpp"

namespace trb {

std::string printable(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  out.reserve(text.size());
  const auto show = [&](unsigned char c) {
    out += "\\u00";
    out += kDigits[c >> 4U];
    out += kDigits[c & 15U];
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    if (c == 0xc2 && next >= 0x80 && next < 0xa0) {
      show(next);
      ++i;
    } else if (c == 0x7f || (c < 0x20 && c != '\n' && c != '\t')) {
      show(c);
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string in_one_line(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '\n') {
      out += "\\u000a";
    } else if (c == '\r') {
      out += "\\u000d";
    } else if (c == '\t') {
      out += "\\u0009";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace trb
