// Places: named poses in the hall's frame (ENU, metres, radians), config/places.json.
#pragma once

#include <map>
#include <string>

#include "common/base/config_fault.hpp"
#include "proto/value.hpp"

namespace trb {

/// A pose in the hall's frame: metres, yaw in radians counter-clockwise from east (REP-103).
struct Pose {
  double x = 0;
  double y = 0;
  double z = 0;
  double yaw = 0;
  bool operator==(const Pose&) const = default;
};

using Places = std::map<std::string, Pose>;

/// Reads config/places.json: {"places": {"NAME": {"x":…, "y":…, "z":…, "yaw":…}}}.
Places read_places(const Value& json, const std::string& file, ConfigFaults& faults);

}  // namespace trb
