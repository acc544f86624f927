// A device with Modbus.
#include "common/drivers/modbus/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_modbus(const NodeConfig& config, const FileFaults& faults);  // check.cpp
void read_modbus_keys(ObjectReader& vendor, VendorCommands& into);      // check.cpp

DriverRow modbus_row() {
  DriverRow row;
  row.transport.name = "modbus";
  row.transport.mode = Mode::direct;
  row.transport.check = check_modbus;
  row.transport.read = read_modbus_keys;
  row.wire = Wire::modbus;
  row.make = make_with<ModbusDriver, read_modbus_vendor>;
  return row;
}

}  // namespace trb::drivers
