// Text lines over TCP, and a Universal Robot's monitor beside them.
#include "common/drivers/registry.hpp"
#include "common/drivers/tcp-text/driver.hpp"
#include "common/drivers/tcp-text/monitored_names.hpp"

namespace trb::drivers {

void check_tcp_text(const NodeConfig& config, const FileFaults& faults);  // check.cpp
void read_tcp_text_keys(ObjectReader& vendor, VendorCommands& into);      // check.cpp

DriverRow tcp_text_row() {
  return {.transport = {.name = "tcp-text",
                        .mode = Mode::direct,
                        .check = check_tcp_text,
                        .read = read_tcp_text_keys,
                        .monitors = {"ur-primary"},
                        .languages = {"urscript"},
                        .wraps = {"urscript-program"},
                        .monitored_values = ur_monitored_values()},
          .wire = Wire::stream,
          .make = [](const DriverSettings& settings) -> Result<std::unique_ptr<Driver>> {
            return std::unique_ptr<Driver>(
                std::make_unique<TcpTextDriver>(settings.commands, settings.id, settings.instance));
          }};
}

}  // namespace trb::drivers
