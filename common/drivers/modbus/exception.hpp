// A Modbus device's negative answers.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/result.hpp"

namespace trb::drivers {

/// `meant`: what was requested, for example "speed (holding 0)". The error is robot_error, with the exception's name.
Error modbus_exception(std::uint8_t code, const std::string& meant);
/// "the device answered 'server device busy' (exception 6)"
std::string modbus_exception_text(std::uint8_t code);

/// One of the addresses or values of the call is wrong: the others may be well.
bool modbus_blames_place(std::uint8_t code);
/// The device asks for another attempt later: it is busy, or still occupied with the one before.
bool modbus_busy(std::uint8_t code);

}  // namespace trb::drivers
