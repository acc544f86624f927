// The parsed content of commands.json for a Modbus device.
#pragma once

#include "common/drivers/modbus/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct ModbusCommands {
  ModbusPlaces values;                                                         ///< by name
  std::map<std::string, std::vector<ModbusAssignment>, std::less<>> commands;  ///< by subtype
};

/// An invalid place counts as given: one mistake, one fault.
ModbusPlaces read_modbus_values(const VendorCommands& vendor, const VendorFaults& faults);

/// Checks that stop and release need no data. What cannot be parsed is left out.
ModbusCommands read_modbus_commands(const VendorCommands& vendor, ModbusPlaces values, const VendorFaults& faults);

/// Both.
ModbusCommands read_modbus_vendor(const VendorCommands& vendor, const Description& description,
                                  const VendorFaults& faults);

}  // namespace trb::drivers
