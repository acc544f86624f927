// A robot with HTTP and JSON.
#include "common/drivers/http-json/driver.hpp"
#include "common/drivers/http-json/keys.hpp"
#include "common/drivers/registry.hpp"

namespace trb::drivers {

void check_http_json(const NodeConfig& config, const FileFaults& faults);  // check.cpp

DriverRow http_json_row() {
  return {
      .transport = {.name = "http-json", .mode = Mode::direct, .check = check_http_json, .read = read_http_json_keys},
      .wire = Wire::stream,
      .make = make_with<HttpJsonDriver, read_http_commands>};
}

}  // namespace trb::drivers
