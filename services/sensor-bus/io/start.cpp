#include "services/sensor-bus/io/start.hpp"

#include <cstdio>

#include "common/config/node_config.hpp"
#include "services/sensor-bus/io/steps.hpp"

namespace trb::sensor {
namespace {

int complain(const std::string& text) {
  std::fprintf(stderr, "trb-sensor-bus: %s\n", text.c_str());
  return 1;
}

}  // namespace

int start(const std::string& node_dir) {
  const NodeCheck check = check_node_dir(node_dir, true);
  const NodeConfig& config = check.config;
  if (!faults_that_stop(check.faults).empty()) return complain("nothing started\n" + to_text(check.faults));
  auto service = Service::open({config.dir, "sensor-bus", SensorBusCore::subtypes()});
  if (!service) return complain(service.error().text());
  SensorBusCore core(config.id);
  Steps steps(**service, core);
  // The devices: Devices devices(**service, steps, ...); steps.to_devices(devices);
  return (*service)->run(steps);
}

}  // namespace trb::sensor
