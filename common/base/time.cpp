#include "common/base/time.hpp"

#include <array>
#include <cstdio>
#include <ctime>

namespace trb {

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
