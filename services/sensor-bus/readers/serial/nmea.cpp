#include "services/sensor-bus/readers/serial/nmea.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "common/base/number_text.hpp"

namespace trb::sensor {
namespace {

constexpr double kKnot = 1852.0 / 3600.0;  // m/s
constexpr std::size_t kMaxFields = 40;

using Fields = std::vector<std::string_view>;

std::string_view field(const Fields& fields, std::size_t at) {
  return at < fields.size() ? fields[at] : std::string_view();
}

Fields split(std::string_view text) {
  Fields out;
  while (out.size() < kMaxFields) {
    const std::size_t comma = text.find(',');
    out.push_back(text.substr(0, comma));
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  return out;
}

bool checksum_is_right(std::string_view body, std::string_view digits) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return digits.size() == 2 && parse_hex_number<unsigned>(digits) == sum;
}

std::optional<double> number(std::string_view text, double from, double to) {
  if (text.empty()) return std::nullopt;
  const auto value = parse_finite(text);
  if (!value || *value < from || *value > to) return std::nullopt;
  return *value;
}

/// "5231.2345","N": degrees and minutes in one number.
std::optional<double> angle(std::string_view text, std::string_view side, char positive, char negative, double most) {
  const auto value = number(text, 0, 18'060);
  const bool has_side = side.size() == 1 && (side[0] == positive || side[0] == negative);
  if (!value || !has_side) return std::nullopt;
  const double degrees = std::floor(*value / 100);
  const double minutes = *value - degrees * 100;
  const double out = degrees + minutes / 60;
  if (minutes >= 60 || out > most) return std::nullopt;
  return side[0] == negative ? -out : out;
}

void read_place(const Fields& fields, std::size_t at, NmeaFix& fix) {
  const auto latitude = angle(field(fields, at), field(fields, at + 1), 'N', 'S', 90);
  const auto longitude = angle(field(fields, at + 2), field(fields, at + 3), 'E', 'W', 180);
  if (!latitude || !longitude) return;
  fix.latitude = latitude;
  fix.longitude = longitude;
}

NmeaFix read_gga(const Fields& fields) {
  NmeaFix fix;
  fix.satellites = number(field(fields, 7), 0, 999);
  const std::string_view quality = field(fields, 6);
  fix.none = quality.empty() || quality == "0";
  if (fix.none) return fix;
  read_place(fields, 2, fix);
  if (field(fields, 10) == "M") fix.altitude = number(field(fields, 9), -20'000, 100'000);
  return fix;
}

NmeaFix read_rmc(const Fields& fields) {
  NmeaFix fix;
  fix.none = field(fields, 2) != "A";
  if (fix.none) return fix;
  read_place(fields, 3, fix);
  if (const auto knots = number(field(fields, 7), 0, 100'000)) fix.speed = *knots * kKnot;
  fix.course = number(field(fields, 8), 0, 360);
  return fix;
}

NmeaFix read_gll(const Fields& fields) {
  NmeaFix fix;
  fix.none = field(fields, 6) != "A";
  if (!fix.none) read_place(fields, 1, fix);
  return fix;
}

Error malformed(const char* what) {
  return fail(Errc::malformed, what, "look at the rule's \"baud\", and whether the device speaks NMEA 0183");
}

}  // namespace

Result<NmeaFix> parse_nmea(std::string_view line) {
  if (!line.starts_with('$')) return malformed("a line that does not begin with '$' is no NMEA sentence");
  const std::size_t star = line.rfind('*');
  if (star == std::string_view::npos) return malformed("an NMEA sentence has no checksum");
  const std::string_view body = line.substr(1, star - 1);
  if (!checksum_is_right(body, line.substr(star + 1))) return malformed("an NMEA sentence has a wrong checksum");
  const Fields fields = split(body);
  const std::string_view kind = fields[0].size() == 5 ? fields[0].substr(2) : std::string_view();
  if (kind == "GGA") return read_gga(fields);
  if (kind == "RMC") return read_rmc(fields);
  if (kind == "GLL") return read_gll(fields);
  return NmeaFix{};
}

std::optional<Measured> NmeaFix::value(NmeaValue which) const {
  const std::array<std::optional<double>, 7> numbers = {std::nullopt, latitude, longitude, altitude,
                                                        speed,        course,   satellites};
  if (which != NmeaValue::position) {
    const auto& found = numbers[static_cast<std::size_t>(which)];
    return found ? std::optional<Measured>(Measured{false, *found, {}}) : std::nullopt;
  }
  if (!latitude || !longitude) return std::nullopt;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.7f,%.7f", *latitude, *longitude);
  return Measured{true, 0, text.data()};
}

}  // namespace trb::sensor
