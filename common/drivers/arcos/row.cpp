// A Pioneer, with ARCOS.
#include "common/drivers/arcos/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_arcos(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow arcos_row() {
  return {.transport = {.name = "arcos", .mode = Mode::direct, .check = check_arcos},
          .wire = Wire::stream,
          .make = make_with<ArcosDriver, read_arcos_commands>};
}

}  // namespace trb::drivers
