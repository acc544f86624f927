// A robot that is programmed to use the field channel.
#include "common/drivers/lines/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

namespace {

void check_lines(const NodeConfig&, const FileFaults&) {}

}  // namespace

DriverRow lines_row() {
  DriverRow row;
  row.transport.name = "lines";
  row.transport.mode = Mode::interpreter;
  row.transport.check = check_lines;
  row.transport.names_values = false;
  row.wire = Wire::none;
  return row;
}

}  // namespace trb::drivers
