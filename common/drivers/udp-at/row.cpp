// A drone that takes AT commands by UDP.
#include "common/drivers/registry.hpp"
#include "common/drivers/udp-at/driver.hpp"

namespace trb::drivers {

void check_udp_at(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow udp_at_row() {
  return {.transport = {.name = "udp-at", .mode = Mode::direct, .check = check_udp_at, .monitors = {"ar-navdata"}},
          .wire = Wire::datagrams,
          .make = make_with<AtDriver, read_at_commands>};
}

}  // namespace trb::drivers
