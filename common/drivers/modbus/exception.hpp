// What a Modbus device answers instead of doing what it was asked.
#pragma once

#include <cstdint>
#include <string>

#include "common/base/result.hpp"

namespace trb::drivers {

/// `meant`: what was asked, for example "speed (holding 0)". The error is robot_error, with the exception's name.
Error modbus_exception(std::uint8_t code, const std::string& meant);

}  // namespace trb::drivers
