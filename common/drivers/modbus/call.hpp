// What the modbus mode and the shell with its connection exchange: one call at a time, one answer each.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/drivers/modbus/syntax.hpp"

namespace trb::drivers {

/// The most registers that one read may ask for.
constexpr std::uint16_t kMostModbusRegisters = 125;

/// Reads `count` coils or registers, or writes `words` (a coil: 0 or 1). Nothing is ever done twice.
struct ModbusCall {
  bool write = false;
  ModbusKind kind{};
  std::uint16_t address = 0;
  std::uint16_t count = 0;
  std::vector<std::uint16_t> words;
};

/// The device's answer; a missing answer is reported as the loss of the connection.
struct ModbusAnswer {
  std::uint8_t exception = 0;        ///< Modbus' exception code; 0: done
  std::vector<std::uint16_t> words;  ///< what was read
};

Bytes encode(const ModbusCall& call);
Bytes encode(const ModbusAnswer& answer);
/// Empty for bytes that encode() never makes.
std::optional<ModbusCall> decode_modbus_call(BytesView bytes);
std::optional<ModbusAnswer> decode_modbus_answer(BytesView bytes);

}  // namespace trb::drivers
