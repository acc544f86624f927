#include "services/sensor-bus/readers/attributes/w1_slave.hpp"

#include "services/sensor-bus/readers/measured.hpp"

namespace trb::sensor {
namespace {

constexpr double kPowerLost = 85'000;

}  // namespace

Result<double> parse_w1_slave(std::string_view text) {
  const std::size_t end = text.find('\n');
  const std::string_view first = text.substr(0, end);
  const std::string_view second = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  const std::size_t at = second.find("t=");
  if (first.find("crc=") == std::string_view::npos || at == std::string_view::npos) {
    return fail(Errc::malformed, quoted_bytes(text) + " is not what a thermometer writes",
                "look at the cable and its power");
  }
  if (!trim(first).ends_with("YES")) return fail(Errc::malformed, "the checksum is wrong", "look at the cable");
  auto value = parse_finite(second.substr(at + 2));
  if (value && *value == kPowerLost) {
    return fail(Errc::malformed, "it tells 85 °C, as after a loss of its power", "look at its power");
  }
  return value;
}

}  // namespace trb::sensor
