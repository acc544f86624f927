// A robot that is programmed to use the field channel.
#include "common/drivers/lines/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

namespace {

void check_lines(const NodeConfig&, const FileFaults&) {}

}  // namespace

DriverRow lines_row() {
  return {.transport = {.name = "lines", .mode = Mode::interpreter, .check = check_lines, .names_values = false},
          .wire = Wire::none};
}

}  // namespace trb::drivers
