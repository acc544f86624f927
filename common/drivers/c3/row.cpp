// A KUKA, with KUKAVARPROXY.
#include "common/drivers/c3/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_c3(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow c3_row() {
  DriverRow row;
  row.transport.name = "c3";
  row.transport.mode = Mode::interpreter;
  row.transport.check = check_c3;
  row.wire = Wire::stream;
  row.make = make_with<C3Driver, read_c3_commands>;
  return row;
}

}  // namespace trb::drivers
