// A device that no rule knows: whether it may be a sensor, and a rule for it to edit.
#pragma once

#include "services/sensor-bus/core/device.hpp"
#include "services/sensor-bus/core/device_events.hpp"

namespace trb::sensor {

/// Not the console's terminals, a laptop's keyboard, a bus itself, or an output.
bool is_worth_listing(const Device& device);

/// Its properties, and a rule that matches it and no other device.
UnknownDevice describe_unknown(const Device& device);

}  // namespace trb::sensor
