// Puts a message's data into a Modbus device: numbers only, so no text can be misinterpreted.
#pragma once

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/drivers/modbus/syntax.hpp"

namespace trb::drivers {

/// The number that the assignment writes: its own, or an item of the data, which is JSON: a number, true, false, or a
/// list of them. Errors: bad_value.
Result<double> modbus_data(const ModbusAssignment& assignment, BytesView data);

}  // namespace trb::drivers
