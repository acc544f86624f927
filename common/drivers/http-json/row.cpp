// A robot with HTTP and JSON.
#include "common/drivers/http-json/driver.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_http_json(const NodeConfig& config, const FileFaults& faults);  // check.cpp
void read_http_json_keys(ObjectReader& vendor, VendorCommands& into);      // check.cpp

DriverRow http_json_row() {
  DriverRow row;
  row.transport.name = "http-json";
  row.transport.mode = Mode::direct;
  row.transport.check = check_http_json;
  row.transport.read = read_http_json_keys;
  row.wire = Wire::stream;
  row.make = make_with<HttpJsonDriver, read_http_commands>;
  return row;
}

}  // namespace trb::drivers
