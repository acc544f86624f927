// Puts a message's data into a Modbus device: numbers only, so no text can be misinterpreted.
#pragma once

#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/drivers/modbus/syntax.hpp"

namespace trb::drivers {

/// The number that the assignment writes: its own, or an item of the data, which is JSON: a number, true, false, or a
/// list of them. Errors: bad_value.
Result<double> modbus_data(const ModbusAssignment& assignment, BytesView data);

/// Whether the data has no items beyond those that the command takes. Errors: bad_value.
Status modbus_takes_all(const std::vector<ModbusAssignment>& writes, BytesView data);

}  // namespace trb::drivers
