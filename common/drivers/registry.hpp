// Every driver: what commands.json may name as a transport, how it is checked, and which class implements it.
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
  none = 0,   ///< nothing: the robot dials TCP_PORT, or another service connects to it
  stream,     ///< a TCP connection to the robot's port, and one to its monitor's
  datagrams,  ///< the same by UDP
  modbus,     ///< a Modbus device, which libmodbus polls
};

struct DriverRow {
  Transport transport;
  Wire wire{};
  /// Null for a robot that uses only the field channel. Errors: bad_value (texts of commands.json that cannot be
  /// parsed).
  Result<std::unique_ptr<Driver>> (*make)(const DriverSettings&) = nullptr;
};

/// The row of that transport, or nullptr.
const DriverRow* find_driver(std::string_view transport);

/// What check_node_dir and check_robot_files ask for.
const Transports& robot_transports();

/// The driver of the robot's own language, or null. Throws std::invalid_argument for texts that cannot be parsed, which
/// a checked node does not have.
std::unique_ptr<Driver> make_driver(const DriverSettings& settings);

}  // namespace trb::drivers
