// A Pioneer, with ARCOS.
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
  row.make = make_with<ArcosDriver, read_arcos_commands>;
  return row;
}

}  // namespace trb::drivers
