#include "common/base/time.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>

#include "common/base/number_text.hpp"

namespace trb {
namespace {

constexpr std::string_view kForm = "0000-00-00T00:00:00";

/// Digits where the form has them, and the same characters elsewhere.
bool has_form(std::string_view text) {
  if (text.size() != kForm.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_digit = text[i] >= '0' && text[i] <= '9';
    if (kForm[i] == '0' ? !is_digit : text[i] != kForm[i]) return false;
  }
  return true;
}

int two_digits(std::string_view text, std::size_t at) {
  return (text[at] - '0') * 10 + (text[at + 1] - '0');
}

/// ".25" as ns.
std::optional<std::int64_t> fraction_of(std::string_view text) {
  if (text.empty()) return 0;
  if (text[0] != '.' || text.size() < 2 || text.size() > 10) return std::nullopt;
  std::string digits(text.substr(1));
  digits.resize(9, '0');
  if (digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return parse_number<std::int64_t>(digits);
}

}  // namespace

std::optional<UtcTime> from_iso8601(std::string_view text) {
  if (!text.ends_with('Z') || !has_form(text.substr(0, kForm.size()))) return std::nullopt;
  const auto fraction = fraction_of(text.substr(kForm.size(), text.size() - kForm.size() - 1));
  const int year = two_digits(text, 0) * 100 + two_digits(text, 2);
  const std::chrono::year_month_day day{std::chrono::year(year),
                                        std::chrono::month(static_cast<unsigned>(two_digits(text, 5))),
                                        std::chrono::day(static_cast<unsigned>(two_digits(text, 8)))};
  const int hour = two_digits(text, 11);
  const int minute = two_digits(text, 14);
  const int second = two_digits(text, 17);
  if (!fraction || !day.ok() || year < 1970 || year > 2200 || hour > 23 || minute > 59 || second > 59)
    return std::nullopt;
  const std::chrono::seconds since = std::chrono::sys_days(day).time_since_epoch() + std::chrono::hours(hour) +
                                     std::chrono::minutes(minute) + std::chrono::seconds(second);
  return UtcTime{std::chrono::nanoseconds(since).count() + *fraction};
}

std::string to_iso8601(UtcTime time) {
  std::int64_t seconds_part = time.ns / 1'000'000'000;
  std::int64_t rest = time.ns % 1'000'000'000;
  if (rest < 0) {
    rest += 1'000'000'000;
    --seconds_part;
  }
  const std::time_t clock = seconds_part;
  std::tm parts{};
  gmtime_r(&clock, &parts);
  std::array<char, 80> out{};
  std::snprintf(out.data(), out.size(), "%04d-%02d-%02dT%02d:%02d:%02d.%03dZ", parts.tm_year + 1900, parts.tm_mon + 1,
                parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec, static_cast<int>(rest / 1'000'000));
  return out.data();
}

}  // namespace trb
