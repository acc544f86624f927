// A message's data into a Modbus device: numbers only, so there is nothing that a text could become.
#pragma once

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/drivers/modbus/syntax.hpp"

namespace trb::drivers {

/// The number that the assignment writes: its own, or an item of the data, which is JSON: a number, true, false, or a
/// list of them. Errors: bad_value.
Result<double> modbus_data(const ModbusAssignment& assignment, BytesView data);

}  // namespace trb::drivers
