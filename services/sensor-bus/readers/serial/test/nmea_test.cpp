#include "services/sensor-bus/readers/serial/nmea.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstdio>

using namespace trb;
using namespace trb::sensor;

namespace {

/// The sentence with its checksum.
std::string sentence(std::string_view body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  std::array<char, 3> digits{};
  std::snprintf(digits.data(), digits.size(), "%02X", sum & 0xffU);
  return "$" + std::string(body) + "*" + digits.data();
}

}  // namespace

TEST_CASE("NMEA tells where a receiver is") {
  const auto gga = parse_nmea("$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47");
  REQUIRE(gga.ok());
  CHECK(*gga->latitude == doctest::Approx(48.1173));
  CHECK(*gga->longitude == doctest::Approx(11.516667));
  CHECK(*gga->altitude == doctest::Approx(545.4));
  CHECK(*gga->satellites == 8);
  CHECK(gga->value(NmeaValue::position)->text == "48.1173000,11.5166667");
  const auto rmc = parse_nmea("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A");
  REQUIRE(rmc.ok());
  CHECK(*rmc->speed == doctest::Approx(11.5236));
  CHECK(*rmc->course == doctest::Approx(84.4));
}

TEST_CASE("an NMEA sentence without a fix tells nothing, a wrong one is an error") {
  const auto none = parse_nmea(sentence("GPGGA,123519,,,,,0,00,,,M,,M,,"));
  CHECK((none && none->none));
  REQUIRE_MESSAGE(none.ok(), none.error().text());
  CHECK_FALSE(none->value(NmeaValue::position).has_value());
  CHECK_FALSE(none->value(NmeaValue::altitude).has_value());
  for (const char* text : {"", "$", "$*", "$*0", "GPGGA,1*00", "$GPGGA,1", "$GPGGA,1*zz",
                           "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*48"}) {
    CHECK_MESSAGE(!parse_nmea(text).ok(), text);
  }
  // The checksum is right; the minutes, the side or the degrees are not.
  for (const char* body :
       {"GPGLL,4860.0,N,01131.0,E,1,A", "GPGLL,4807.0,X,01131.0,E,1,A", "GPGLL,9107.0,N,01131.0,E,1,A",
        "GPGLL,4807.0,N,18131.0,E,1,A", "GPGLL,4807.0,N,01131.0,E,1,V"}) {
    const auto fix = parse_nmea(sentence(body));
    REQUIRE(fix.ok());
    CHECK_MESSAGE(!fix->latitude.has_value(), body);
  }
}
