// A KUKA, with KUKAVARPROXY.
#include "common/drivers/c3/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_c3(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow c3_row() {
  return {.transport = {.name = "c3", .mode = Mode::direct, .check = check_c3, .takes_fields = true},
          .wire = Wire::stream,
          .make = make_with<C3Driver, read_c3_commands>};
}

}  // namespace trb::drivers
