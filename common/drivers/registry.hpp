// Every driver: what commands.json may name as a transport, how it is checked, and who speaks it.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "common/config/transports.hpp"
#include "common/drivers/driver.hpp"
#include "common/drivers/driver_settings.hpp"

namespace trb::drivers {

/// What the shell has to open for a driver.
enum class Wire : std::uint8_t {
  none = 0,   ///< nothing: the robot dials TCP_PORT, or another service speaks to it
  stream,     ///< a TCP connection to the robot's port, and one to its monitor's
  datagrams,  ///< the same by UDP
  modbus,     ///< a Modbus device, which libmodbus asks
};

struct DriverRow {
  Transport transport;
  Wire wire{};
  /// None for a robot that is spoken to in fields alone. Errors: bad_value (words of commands.json that cannot be
  /// read).
  Result<std::unique_ptr<Driver>> (*make)(const DriverSettings&) = nullptr;
};

/// The row of that transport, or nullptr.
const DriverRow* find_driver(std::string_view transport);

/// What check_node_dir and check_robot_files ask for.
const Transports& robot_transports();

/// The driver of the robot's own language; none without one. Throws std::invalid_argument for words that cannot be
/// read: those of a node that was checked can.
std::unique_ptr<Driver> make_driver(const DriverSettings& settings);

}  // namespace trb::drivers
