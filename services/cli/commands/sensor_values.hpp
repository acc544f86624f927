// What simulated sensors tell, as `trb simulate --sensor-values FILE` has it.
#pragma once

#include "proto/value.hpp"
#include "services/cli/commands/fleet_folders.hpp"

namespace trb::cli {

/// The list (services/simulator/README.md, "Sensors") with what its entries leave out and their nodes' rules say: kind,
/// unit, period. An entry that no rule fits stays as it is: a program may feed such a sensor.
Value with_rules(Value list, const FolderSensors& rules);

}  // namespace trb::cli
