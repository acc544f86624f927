// Navdata's values, by the names that commands.json may use (syntax.hpp).
#pragma once

#include <string>
#include <vector>

#include "common/drivers/udp-at/navdata.hpp"

namespace trb::drivers {

struct ArValue {
  std::string name;
  double number = 0;
  std::string json;
};

/// One for each of at_value_names(). Bits are 0 or 1; `state` is the number of the drone's control state, in JSON its
/// name.
std::vector<ArValue> ar_values(const ArNavdata& drone);

}  // namespace trb::drivers
