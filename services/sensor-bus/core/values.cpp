#include "services/sensor-bus/core/values.hpp"

#include <charconv>
#include <cmath>

#include "common/fleet/did_you_mean.hpp"

namespace trb::sensor {
namespace {

constexpr double kPowerLost = 85'000;

std::string_view trim(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<std::string_view> field_of(std::string_view line, char separator, std::size_t number) {
  while (--number > 0) {
    const std::size_t at = line.find(separator);
    if (at == std::string_view::npos) return std::nullopt;
    line.remove_prefix(at + 1);
  }
  return line.substr(0, line.find(separator));
}

/// Control characters around a tag, as STX and ETX, are no part of it.
std::string text_of(std::string_view bytes) {
  std::string out;
  for (const char c : bytes) {
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) out += c;
  }
  return cut_utf8(trim(out), 255);
}

std::string shown(std::string_view text) {
  return in_quotes(cut_utf8(text_of(text.substr(0, 100)), 40));
}

}  // namespace

Result<double> parse_number(std::string_view text) {
  std::string_view digits = trim(text);
  if (digits.starts_with('+') && digits.size() > 1 && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = problem == std::errc() && end == digits.data() + digits.size();
  if (whole && std::isfinite(value)) return value;
  return fail(Errc::malformed, digits.empty() ? "there is no number" : shown(digits) + " is no number",
              "look at the device, and at how the rule reads it");
}

Result<double> parse_w1_slave(std::string_view text) {
  const std::size_t end = text.find('\n');
  const std::string_view first = text.substr(0, end);
  const std::string_view second = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  const std::size_t at = second.find("t=");
  if (first.find("crc=") == std::string_view::npos || at == std::string_view::npos) {
    return fail(Errc::malformed, shown(text) + " is not what a thermometer writes", "look at the cable and its power");
  }
  if (!trim(first).ends_with("YES")) return fail(Errc::malformed, "the checksum is wrong", "look at the cable");
  auto value = parse_number(second.substr(at + 2));
  if (value && *value == kPowerLost) {
    return fail(Errc::malformed, "it tells 85 °C, as after a loss of its power", "look at its power");
  }
  return value;
}

Result<std::optional<Measured>> parse_line(const SensorRule& rule, const SensorChannel& channel,
                                           std::string_view line) {
  std::optional<std::string_view> found = line;
  if (channel.pattern) found = channel.pattern->find(line);
  if (channel.field) found = field_of(line, rule.separator, *channel.field);
  if (!found) return std::optional<Measured>();
  if (channel.is_text) {
    Measured value{true, 0, text_of(*found)};
    if (value.text.empty()) return std::optional<Measured>();
    return std::optional<Measured>(std::move(value));
  }
  const auto number = parse_number(*found);
  if (!number) return number.error();
  return std::optional<Measured>(Measured{false, *number, {}});
}

}  // namespace trb::sensor
