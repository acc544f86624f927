// A drone that takes AT commands by UDP.
#include "common/drivers/registry.hpp"
#include "common/drivers/udp-at/driver.hpp"

namespace trb::drivers {

void check_udp_at(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow udp_at_row() {
  DriverRow row;
  row.transport.name = "udp-at";
  row.transport.mode = Mode::direct;
  row.transport.check = check_udp_at;
  row.transport.monitors = {"ar-navdata"};
  row.wire = Wire::datagrams;
  row.make = make_with<AtDriver, read_at_commands>;
  return row;
}

}  // namespace trb::drivers
