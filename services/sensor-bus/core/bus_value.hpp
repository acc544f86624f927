// A sensor's value as it goes over D-Bus: the arguments of the signal `value` of interface trbots.NAME.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/sensor_name.hpp"

namespace trb::sensor {

/// One value. A program that feeds a sensor may leave out all but the value itself.
struct BusValue {
  bool is_text = false;
  double number = 0;
  std::string text;
  std::string unit;
  std::optional<std::int64_t> time;  ///< of the measurement: UTC, ns; none: now
  std::string quality = "good";      ///< "good", "stale", "bad"
};

/// An argument of any basic type; a variant counts as what is in it. `std::monostate`: of a type that is not basic.
using BusArgument = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string>;

/// Largest text that a sensor sends, in bytes.
constexpr std::size_t kMaxValueText = 1024;

/// (value, unit: s, time: x UTC ns, quality: s); what follows is ignored. Errors: missing, bad_value, too_large.
Result<BusValue> read_bus_value(const std::vector<BusArgument>& arguments);

/// The NAME of path /trbots/NAME and interface trbots.NAME; none if they are not of one sensor.
std::optional<std::string> sensor_of(std::string_view path, std::string_view interface);

/// What can be made of a wish: other characters become '_', too long ones are cut.
std::string to_sensor_name(std::string_view wish);

}  // namespace trb::sensor
