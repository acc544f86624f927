// A device with Modbus.
#include "common/drivers/modbus/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_modbus(const NodeConfig& config, const FileFaults& faults);  // check.cpp
void read_modbus_keys(ObjectReader& vendor, VendorCommands& into);      // check.cpp

DriverRow modbus_row() {
  return {.transport = {.name = "modbus", .mode = Mode::direct, .check = check_modbus, .read = read_modbus_keys},
          .wire = Wire::modbus,
          .make = make_with<ModbusDriver, read_modbus_vendor>};
}

}  // namespace trb::drivers
