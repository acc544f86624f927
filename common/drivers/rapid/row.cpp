// An ABB whose RAPID program takes requests as text.
#include "common/drivers/rapid/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_rapid(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow rapid_row() {
  return {.transport = {.name = "rapid", .mode = Mode::direct, .check = check_rapid, .monitors = {"rapid-service"}},
          .wire = Wire::stream,
          .make = make_with<RapidDriver, read_rapid_commands>};
}

}  // namespace trb::drivers
