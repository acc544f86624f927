// A Pioneer, by ARCOS.
#include "common/drivers/arcos/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_arcos(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow arcos_row() {
  DriverRow row;
  row.transport.name = "arcos";
  row.transport.mode = Mode::interpreter;
  row.transport.check = check_arcos;
  row.wire = Wire::stream;
  row.make = [](const DriverSettings& settings) -> std::unique_ptr<Driver> {
    return std::make_unique<ArcosDriver>(settings.commands, settings.id);
  };
  return row;
}

}  // namespace trb::drivers
