#pragma once

#include <cstdint>
#include <optional>

namespace trb::virtual_robots::plc {

/** The four tables of a Modbus server. */
enum class Table { coils, discrete_inputs, input_registers, holding_registers };

/** Why a request is not carried out; the number is sent. */
enum class Exception : std::uint8_t {
  none = 0,
  illegal_function = 1,
  illegal_address = 2,
  illegal_value = 3,
  device_failure = 4,
};

/** The registers on which requests act. A bit is 0 or 1. */
class Memory {
 public:
  Memory() = default;
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  virtual ~Memory() = default;

  /** Nothing if there is no such bit or register. */
  virtual std::optional<std::uint16_t> read(Table table, std::uint16_t address) const = 0;
  /** Is a write() of this value allowed? */
  virtual Exception check(Table table, std::uint16_t address, std::uint16_t value) const = 0;
  virtual void write(Table table, std::uint16_t address, std::uint16_t value) = 0;
};

}  // namespace trb::virtual_robots::plc
