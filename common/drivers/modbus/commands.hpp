// What commands.json says for a Modbus device, read.
#pragma once

#include "common/drivers/modbus/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct ModbusCommands {
  ModbusPlaces values;                                                         ///< by name
  std::map<std::string, std::vector<ModbusAssignment>, std::less<>> commands;  ///< by subtype
};

/// A place that cannot be read counts as given: one mistake, one fault.
ModbusPlaces read_modbus_values(const VendorCommands& vendor, const VendorFaults& faults);

/// Stop and release need no data. What cannot be read is left out.
ModbusCommands read_modbus_commands(const VendorCommands& vendor, ModbusPlaces values, const VendorFaults& faults);

/// Both.
ModbusCommands read_modbus_vendor(const VendorCommands& vendor, const Description& description,
                                  const VendorFaults& faults);

}  // namespace trb::drivers
