// Whether what a skill may send fits into the registers that its command writes: known from the two files.
#pragma once

#include "common/config/node_config.hpp"
#include "common/drivers/modbus/commands.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

/// A fault of the command for a skill whose data it can never take: no JSON, a text, too few items or too many; or for
/// a bound or the default of a skill's parameter that a value which it writes cannot hold.
void check_written_bounds(const NodeConfig& config, const ModbusCommands& commands, const VendorFaults& faults);

}  // namespace trb::drivers
