// NMEA 0183: the sentences that tell where a receiver is. A sentence without a right checksum is ignored.
#pragma once

#include <optional>
#include <string_view>

#include "common/fleet/sensor_rule.hpp"
#include "services/sensor-bus/readers/measured.hpp"

namespace trb::sensor {

/// What a sentence tells; an empty one: it has no fix, or is of a kind that tells none of it.
struct NmeaFix {
  std::optional<double> latitude;   ///< degrees, north
  std::optional<double> longitude;  ///< degrees, east
  std::optional<double> altitude;   ///< m above the geoid
  std::optional<double> speed;      ///< m/s
  std::optional<double> course;     ///< degrees from north, clockwise
  std::optional<double> satellites;
  bool none = false;  ///< it says that it has no fix

  /// "LATITUDE,LONGITUDE" as text, the rest as numbers.
  [[nodiscard]] std::optional<Measured> value(NmeaValue which) const;
};

/// "$GPGGA,…*47"; GGA, RMC and GLL of any talker. Errors: malformed, with what is wrong.
Result<NmeaFix> parse_nmea(std::string_view line);

}  // namespace trb::sensor
