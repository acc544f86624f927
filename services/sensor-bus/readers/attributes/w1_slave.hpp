// What a 1-Wire thermometer writes.
#pragma once

#include <string_view>

#include "common/base/result.hpp"

namespace trb::sensor {

/// The two lines of w1_slave: "… crc=4b YES", "… t=21500"; in m°C. Errors: malformed (also a checksum that is wrong,
/// and 85 °C, which a thermometer tells that has lost its power while measuring).
Result<double> parse_w1_slave(std::string_view text);

}  // namespace trb::sensor
