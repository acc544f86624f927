#include "services/sensor-bus/io/start.hpp"

#include "common/config/node_config.hpp"
#include "common/config/sensor_files.hpp"
#include "common/log/log.hpp"
#include "services/sensor-bus/io/bus_thread.hpp"
#include "services/sensor-bus/io/devices/devices.hpp"
#include "services/sensor-bus/io/sensor_bus_shell.hpp"

namespace trb::sensor {
namespace {

std::set<std::string> words_of_robot(const NodeConfig& config) {
  if (config.framework.empty()) return {};
  std::set<std::string> requests;
  for (const auto& [subtype, words] : config.commands.requests) requests.insert(subtype);
  return robots_words(std::move(requests));
}

}  // namespace

Result<int> start(NodeConfig config) {
  auto service =
      Service::open({config.dir, "sensor-bus", SensorBusCore::Taken::subtypes(), {std::string(PeerExpired::kSubtype)}});
  if (!service) return service.error();
  ConfigFaults faults;  // told by the check above
  SensorBusCore core(config.id, words_of_robot(config));
  SensorBusShell shell(**service, core);
  auto bus = BusThread::open(config.dbus, **service,
                             [&](const std::vector<BusEvent>& events) { shell.on_bus_events(events); });
  if (!bus) return bus.error();
  shell.to_bus([&](std::vector<Effect> effects) { (*bus)->carry_out(std::move(effects)); });
  const auto devices = Devices::open(**service, shell, read_sensor_files(config.dir, faults));
  // Without them it still receives the sensors that programs feed.
  if (!devices) log_event(Level::error, "no_devices", devices.error().text());
  if (devices) shell.to_devices(**devices);
  return (*service)->run(shell);
}

}  // namespace trb::sensor
