#include "services/sensor-bus/readers/measured.hpp"

#include <cmath>

#include "common/base/number_text.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "proto/value.hpp"

namespace trb::sensor {

std::string_view trim(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string plain_text(std::string_view bytes) {
  std::string out;
  for (const char c : bytes) {
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) out += c;
  }
  return cut_utf8(trim(out), 255);
}

std::string quoted_bytes(std::string_view text) {
  return in_quotes(cut_utf8(plain_text(text.substr(0, 100)), 40));
}

Result<double> parse_finite(std::string_view text) {
  std::string_view digits = trim(text);
  if (digits.starts_with('+') && digits.size() > 1 && digits[1] != '-') digits.remove_prefix(1);
  const auto value = parse_number<double>(digits);
  if (value && std::isfinite(*value)) return *value;
  return fail(Errc::malformed, digits.empty() ? "there is no number" : quoted_bytes(digits) + " is no number",
              "look at the device, and at how the rule reads it");
}

}  // namespace trb::sensor
