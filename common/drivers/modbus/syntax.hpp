// The notation of commands.json for a robot with Modbus: where a value is, and what a command writes.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/config/node_config.hpp"
#include "proto/field.hpp"

namespace trb::drivers {

/// How a Modbus device is polled.
struct ModbusSettings {
  int unit = 1;            ///< the device behind the address: 0 to 247, or 255
  double poll_s = 0.1;     ///< how often its values are polled
  double timeout_s = 0.5;  ///< how long an answer may take before the connection is given up
};
ModbusSettings modbus_settings(const VendorCommands& vendor);

/// The four tables of a Modbus device.
enum class ModbusKind : std::uint8_t { coil = 0, discrete, input, holding };
constexpr auto enum_names(ModbusKind) {
  return std::array<std::string_view, 4>{"coil", "discrete", "input", "holding"};
}

enum class ModbusType : std::uint8_t { boolean = 0, int16, uint16, int32, uint32, float32 };
constexpr auto enum_names(ModbusType) {
  return std::array<std::string_view, 6>{"bool", "int16", "uint16", "int32", "uint32", "float32"};
}

/// Where a value is and how it is encoded: value = register * factor + offset.
struct ModbusPlace {
  ModbusKind kind{};
  std::uint16_t address = 0;  ///< as sent on the wire, counted from 0
  ModbusType type{};
  bool low_word_first = false;  ///< of two registers, the first holds the lower half
  double factor = 1;
  double offset = 0;

  /// Coils or registers that it takes.
  [[nodiscard]] std::uint16_t size() const { return type >= ModbusType::int32 ? 2 : 1; }
  [[nodiscard]] bool writable() const { return kind == ModbusKind::coil || kind == ModbusKind::holding; }
};

using ModbusPlaces = std::map<std::string, ModbusPlace, std::less<>>;

/// "KIND ADDRESS [TYPE] [low_word_first] [* FACTOR] [+ OFFSET]", for example `coil 0`, `holding 4 float32`,
/// `input 2 int16 * 0.1 - 40`. Without a type: bool for coil and discrete, uint16 for the registers.
/// Errors: bad_value.
Result<ModbusPlace> read_modbus_place(std::string_view text);

/// One line of a command.
struct ModbusAssignment {
  static constexpr int kLiteral = -2;
  static constexpr int kWhole = -1;

  std::string name;  ///< as written in commands.json
  ModbusPlace place;
  int item = kLiteral;  ///< the item of the data that is written, kWhole for {data}, or kLiteral
  double literal = 0;
};

/// "NAME = NUMBER" a line, the name one of `values` or a place; the number may be true, false, {data} or {0}, {1} …
/// Errors: bad_value, missing (no such value).
Result<std::vector<ModbusAssignment>> read_modbus_assignments(std::string_view text, const ModbusPlaces& values);

/// "coil 0", as a person finds it in the device's documentation.
std::string to_text(const ModbusPlace& place);

/// The words to write for that value. Errors: bad_value (the type cannot hold it).
Result<std::vector<std::uint16_t>> modbus_words(const ModbusPlace& place, double number);

/// Whether the type can hold that number, or the nearest one. Errors: bad_value.
Status modbus_holds(const ModbusPlace& place, double number);

/// Whether the register ever has that number, as a person reads it. Errors: bad_value.
Status modbus_has(const ModbusPlace& place, double number);

/// Whether the register ever goes above that number, or below it. Errors: bad_value.
Status modbus_passes(const ModbusPlace& place, double number, bool above);

/// The value of size() words. Errors: bad_value (a float32 that is not a number).
Result<double> modbus_number(const ModbusPlace& place, const std::vector<std::uint16_t>& words);

}  // namespace trb::drivers
