// Whether a sensor's unit is known: a program's tells it only with its values, which are read when somebody asks.
#pragma once

#include <string_view>

#include "proto/bodies/sensor.hpp"

namespace trb {

/// The `detail` of such a sensor before its first value is read: an empty unit means nothing then.
constexpr std::string_view kUnitNotRead = "nobody has read it yet, so its unit is not known";

inline bool is_unit_known(const SensorInfo& info) {
  return info.detail != kUnitNotRead;
}

}  // namespace trb
