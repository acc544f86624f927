// An ABB whose RAPID program takes requests as text.
#include "common/drivers/rapid/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_rapid(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow rapid_row() {
  DriverRow row;
  row.transport.name = "rapid";
  row.transport.mode = Mode::interpreter;
  row.transport.check = check_rapid;
  row.transport.monitors = {"rapid-service"};
  row.wire = Wire::stream;
  row.make = make_with<RapidDriver, read_rapid_commands>;
  return row;
}

}  // namespace trb::drivers
