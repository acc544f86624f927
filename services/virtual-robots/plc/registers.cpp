#include "services/virtual-robots/plc/registers.hpp"

#include <bit>
#include <cmath>

namespace trb::virtual_robots::plc {
namespace {

enum Coil : std::uint16_t { kRunning, kReset, kCoils };
enum HoldingRegister : std::uint16_t { kSpeed, kJog };

std::uint16_t tenths(double value) {
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(value * 10)));
}

std::uint16_t high(std::uint32_t value) {
  return static_cast<std::uint16_t>(value >> 16U);
}

std::uint16_t low(std::uint32_t value) {
  return static_cast<std::uint16_t>(value & 0xffffU);
}

}  // namespace

std::optional<std::uint16_t> Registers::read(Table table, std::uint16_t address) const {
  switch (table) {
    case Table::coils:
      return coil(address);
    case Table::discrete_inputs:
      return discrete_input(address);
    case Table::input_registers:
      return input_register(address);
    case Table::holding_registers:
      break;
  }
  if (address == kSpeed) return conveyor_.speed_setting();
  return address == kJog ? std::optional(static_cast<std::uint16_t>(conveyor_.jog_setting())) : std::nullopt;
}

std::optional<std::uint16_t> Registers::coil(std::uint16_t address) const {
  if (address >= kCoils) return std::nullopt;
  return address == kRunning && conveyor_.running() ? 1 : 0;
}

std::optional<std::uint16_t> Registers::discrete_input(std::uint16_t address) const {
  const FaultCode fault = conveyor_.fault_code();
  switch (address) {
    case 0:
      return conveyor_.box_at_exit();
    case 1:
      return conveyor_.box_at_entry(now_);
    case 2:
      return fault == FaultCode::motor_overload;
    case 3:
      return fault == FaultCode::emergency_stop;
    default:
      return std::nullopt;
  }
}

std::optional<std::uint16_t> Registers::input_register(std::uint16_t address) const {
  const auto current = std::bit_cast<std::uint32_t>(static_cast<float>(conveyor_.current_a()));
  switch (address) {
    case 0:
      return static_cast<std::uint16_t>(conveyor_.state());
    case 1:
      return static_cast<std::uint16_t>(conveyor_.position_mm(now_));
    case 2:
      return static_cast<std::uint16_t>(conveyor_.speed());
    case 3:
      return static_cast<std::uint16_t>(conveyor_.fault_code());
    case 4:
      return tenths(conveyor_.temperature());
    case 5:
      return tenths(230.4);  // the mains
    case 6:
      return high(conveyor_.boxes());
    case 7:
      return low(conveyor_.boxes());
    case 8:
      return high(current);
    case 9:
      return low(current);
    default:
      return std::nullopt;
  }
}

Exception Registers::check(Table table, std::uint16_t address, std::uint16_t value) const {
  if (table == Table::coils) {
    if (address >= kCoils) return Exception::illegal_address;
    return address == kRunning && value == 1 && !conveyor_.may_run() ? Exception::device_failure : Exception::none;
  }
  if (table != Table::holding_registers || address > kJog) return Exception::illegal_address;
  if (address == kJog) {
    const auto speed = static_cast<std::int16_t>(value);
    if (speed > Conveyor::kFastest || speed < -Conveyor::kFastest) return Exception::illegal_value;
    return speed == 0 || conveyor_.may_jog() ? Exception::none : Exception::device_failure;
  }
  const bool good = value >= Conveyor::kSlowest && value <= Conveyor::kFastest;
  return good ? Exception::none : Exception::illegal_value;
}

void Registers::write(Table table, std::uint16_t address, std::uint16_t value) {
  if (table == Table::holding_registers && address == kJog) {
    return conveyor_.jog(static_cast<std::int16_t>(value), now_);
  }
  if (table == Table::holding_registers) return conveyor_.set_speed(value, now_);
  if (address == kRunning) return conveyor_.run(value == 1, now_);
  if (address == kReset && value == 1) conveyor_.reset(now_);
}

}  // namespace trb::virtual_robots::plc
