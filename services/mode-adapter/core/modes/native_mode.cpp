#include "services/mode-adapter/core/modes/native_mode.hpp"

#include "services/mode-adapter/core/modes/arcos_mode.hpp"
#include "services/mode-adapter/core/modes/at_mode.hpp"
#include "services/mode-adapter/core/modes/c3_mode.hpp"
#include "services/mode-adapter/core/modes/direct_mode.hpp"
#include "services/mode-adapter/core/modes/modbus_mode.hpp"
#include "services/mode-adapter/core/modes/rapid_mode.hpp"
#include "services/mode-adapter/core/modes/ros_mode.hpp"

namespace trb::adapter {

std::unique_ptr<RobotMode> make_native_mode(const Settings& settings) {
  const std::string& transport = settings.commands.transport;
  if (transport == "tcp-text") return std::make_unique<DirectMode>(settings.commands, settings.id);
  if (transport == "arcos") return std::make_unique<ArcosMode>(settings.commands, settings.id);
  if (transport == "udp-at") return std::make_unique<AtMode>(settings.commands, settings.id);
  if (transport == "rapid") return std::make_unique<RapidMode>(settings);
  if (transport == "c3") return std::make_unique<C3Mode>(settings);
  if (transport == "ros") {
    return std::make_unique<RosMode>(settings.commands, settings.description, settings.id, settings.instance);
  }
  if (transport == "modbus") return std::make_unique<ModbusMode>(settings.commands, settings.description, settings.id);
  return nullptr;
}

}  // namespace trb::adapter
