// A Modbus device's negative answers.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/result.hpp"

namespace trb::drivers {

/// `meant`: what was requested, for example "speed (holding 0)". The error is robot_error, with the exception's name.
Error modbus_exception(std::uint8_t code, const std::string& meant);

}  // namespace trb::drivers
