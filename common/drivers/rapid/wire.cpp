#include "common/drivers/rapid/wire.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace trb::drivers {
namespace {

constexpr Duration kSilence = std::chrono::milliseconds(100);
constexpr std::string_view kEnds = "#\n";

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text.substr(0, text.find_last_not_of(" \t\r\n") + 1);
}

std::string_view take_word(std::string_view& text) {
  text = trimmed(text);
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  return word;
}

std::optional<double> read_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  const bool whole = error == std::errc() && end == word.data() + word.size() && std::isfinite(number);
  return whole ? std::optional(number) : std::nullopt;
}

bool is_plain(char c) {
  return c > ' ' && c <= '~' && c != '#' && c != '%' && c != '"';
}

std::string escaped(const std::string& text) {
  if (text.empty()) return "%";
  std::string out;
  for (const char c : text) {
    std::array<char, 4> hex{};
    std::snprintf(hex.data(), hex.size(), "%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    out += is_plain(c) ? std::string(1, c) : std::string(hex.data());
  }
  return out;
}

std::string number(double value) {
  std::array<char, 32> text{};
  const int size = std::snprintf(text.data(), text.size(), "%.6g", value);
  return {text.data(), static_cast<std::size_t>(size)};
}

}  // namespace

Result<RapidAnswer> read_rapid_answer(std::string_view line) {
  std::string_view rest = line;
  const auto code = read_number(take_word(rest));
  const auto ok = read_number(take_word(rest));
  if (!code || !ok || *code < 0 || *code > 9999 || *code != std::floor(*code)) {
    return fail(Errc::malformed, "the robot's answer does not begin with a code and 1 or 0");
  }
  RapidAnswer answer{static_cast<int>(*code), *ok == 1, {}, rapid_unescaped(trimmed(rest))};
  while (!trimmed(rest).empty()) {
    const auto value = read_number(take_word(rest));
    if (!value) break;
    answer.numbers.push_back(*value);
  }
  return answer;
}

Result<std::string> rapid_literal(const Value& value) {
  if (value.is_number()) return number(value.number());
  if (value.is_bool()) return std::string(value.boolean() ? "1" : "0");
  if (value.is_text()) return escaped(value.text());
  if (!value.is_list()) {
    return fail(Errc::bad_value, "RAPID takes no " + std::string(value.kind()) + " here",
                "give a number, true or false, a text, or a list of them");
  }
  std::string out;
  for (const Value& item : value.list()) {
    if (item.is_list()) return fail(Errc::bad_value, "RAPID takes no list in a list", "give a list of numbers");
    auto text = rapid_literal(item);
    if (!text) return text;
    out += (out.empty() ? "" : " ") + *text;
  }
  return out;
}

std::string rapid_unescaped(std::string_view text) {
  if (text == "%") return {};  // an empty text; a single percent sign is sent as %25
  std::string out;
  while (!text.empty()) {
    unsigned byte = 0;
    const bool escape = text.front() == '%' && text.size() >= 3;
    const auto [end, error] = escape ? std::from_chars(text.data() + 1, text.data() + 3, byte, 16)
                                     : std::from_chars_result{text.data(), std::errc::invalid_argument};
    const bool whole = error == std::errc() && end == text.data() + 3;
    out += whole ? static_cast<char>(byte) : text.front();
    text.remove_prefix(whole ? 3 : 1);
  }
  return out;
}

void RapidReader::add(BytesView bytes, MonotonicTime now) {
  buffer_ += bytes;
  heard_ = now;
}

std::optional<std::string> RapidReader::next(MonotonicTime now) {
  for (;;) {
    buffer_.erase(0, std::min(buffer_.find_first_not_of(" \r\n#"), buffer_.size()));
    if (buffer_.empty()) return std::nullopt;
    const std::size_t end = buffer_.find_first_of(kEnds);
    if (end == Bytes::npos && (ends_ || now - heard_ < kSilence)) return std::nullopt;
    ends_ = ends_ || end != Bytes::npos;
    std::string answer = buffer_.substr(0, end);
    buffer_.erase(0, end);
    if (!trimmed(answer).empty()) return answer;
  }
}

std::optional<MonotonicTime> RapidReader::next_deadline() const {
  return buffer_.empty() || ends_ ? std::nullopt : std::optional(heard_ + kSilence);
}

}  // namespace trb::drivers
