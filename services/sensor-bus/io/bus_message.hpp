#pragma once

#include <sdbus-c++/sdbus-c++.h>

#include <vector>

#include "services/sensor-bus/core/bus_value.hpp"

namespace trb::sensor {

/// The first four arguments of a signal; those behind one that is not basic are not read.
std::vector<BusArgument> read_arguments(sdbus::Message& message);

}  // namespace trb::sensor
