#include "common/drivers/modbus/exception.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace trb::drivers {
namespace {

struct Exception {
  std::uint8_t code;
  std::string_view name;
  std::string_view hint;
};

// Modbus Application Protocol V1.1b3, section 7.
constexpr std::array<Exception, 9> kExceptions{{
    {1, "illegal function", "look in the device's manual which kinds it has: coil, discrete, input, holding"},
    {2, "illegal data address",
     "look the address up in the device's manual, counted from 0, and correct commands.json"},
    {3, "illegal data value", "give a value within the limits of the device's manual"},
    {4, "server device failure", "look at the device: it has failed, or its program refuses this now"},
    {5, "acknowledge", "the device has taken it and needs longer: ask for its state, do not send it again"},
    {6, "server device busy", "send it again when the device is free"},
    {8, "memory parity error", "the device's memory has failed: it needs service"},
    {10, "gateway path unavailable", "look at the gateway, and at \"unit\" in commands.json"},
    {11, "gateway target device failed to respond",
     "look whether the device behind the gateway is on, and at \"unit\""},
}};

}  // namespace

bool modbus_blames_place(std::uint8_t code) {
  constexpr std::uint8_t kAddress = 2;
  constexpr std::uint8_t kValue = 3;
  return code == kAddress || code == kValue;
}

bool modbus_busy(std::uint8_t code) {
  constexpr std::uint8_t kAcknowledge = 5;
  constexpr std::uint8_t kBusy = 6;
  return code == kAcknowledge || code == kBusy;
}

std::string modbus_exception_text(std::uint8_t code) {
  const auto* const known = std::ranges::find(kExceptions, code, &Exception::code);
  const bool is_known = known != kExceptions.end();
  const std::string name = is_known ? "'" + std::string(known->name) + "'" : "an exception of its own";
  return "the device answered " + name + " (exception " + std::to_string(code) + ")";
}

Error modbus_exception(std::uint8_t code, const std::string& meant) {
  const auto* const known = std::ranges::find(kExceptions, code, &Exception::code);
  return fail(Errc::robot_error, meant + ": " + modbus_exception_text(code),
              known != kExceptions.end() ? std::string(known->hint) : "look the exception up in the device's manual");
}

}  // namespace trb::drivers
