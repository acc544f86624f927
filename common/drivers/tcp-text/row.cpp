// Text lines over TCP, and a Universal Robot's monitor beside them.
#include "common/drivers/registry.hpp"
#include "common/drivers/tcp-text/driver.hpp"

namespace trb::drivers {

void check_tcp_text(const NodeConfig& config, const FileFaults& faults);  // check.cpp
void read_tcp_text_keys(ObjectReader& vendor, VendorCommands& into);      // check.cpp

DriverRow tcp_text_row() {
  DriverRow row;
  row.transport.name = "tcp-text";
  row.transport.mode = Mode::direct;
  row.transport.check = check_tcp_text;
  row.transport.read = read_tcp_text_keys;
  row.transport.monitors = {"ur-primary"};
  row.transport.languages = {"urscript"};
  row.transport.wraps = {"urscript-program"};
  row.transport.monitored_values = {"joints", "robot_mode", "safety", "program_running"};
  row.wire = Wire::stream;
  row.make = [](const DriverSettings& settings) -> Result<std::unique_ptr<Driver>> {
    return std::unique_ptr<Driver>(std::make_unique<TcpTextDriver>(settings.commands, settings.id));
  };
  return row;
}

}  // namespace trb::drivers
