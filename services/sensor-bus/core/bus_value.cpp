#include "services/sensor-bus/core/bus_value.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/bytes.hpp"
#include "proto/value.hpp"

namespace trb::sensor {
namespace {

constexpr std::size_t kMaxName = 64;
constexpr std::size_t kMaxUnit = 16;
constexpr std::string_view kPath = "/trbots/";
constexpr std::string_view kInterface = "trbots.";

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

Status set_number(BusValue& value, double number) {
  if (!std::isfinite(number)) return fail(Errc::bad_value, "value: is no finite number", "tell nothing instead");
  value.number = number;
  return Done{};
}

Status set_text(BusValue& value, const std::string& text) {
  if (text.size() > kMaxValueText)
    return fail(Errc::too_large, "value: " + std::to_string(text.size()) + " bytes or more", "1024 at most");
  if (!is_utf8(text)) return fail(Errc::bad_value, "value: is no UTF-8");
  value.is_text = true;
  value.text = text;
  return Done{};
}

Status read_value(const BusArgument& argument, BusValue& value) {
  return std::visit(Overloaded{[](std::monostate) -> Status {
                                 return fail(Errc::bad_value, "value: is neither a number nor a text",
                                             "tell a d or an s");
                               },
                               [&](const std::string& text) { return set_text(value, text); },
                               [&](auto number) { return set_number(value, static_cast<double>(number)); }},
                    argument);
}

Status read_unit(const BusArgument& argument, BusValue& value) {
  const auto* text = std::get_if<std::string>(&argument);
  if (text == nullptr || text->size() > kMaxUnit || !is_utf8(*text))
    return fail(Errc::bad_value, "unit: is no text of at most 16 bytes");
  value.unit = *text;
  return Done{};
}

Status read_time(const BusArgument& argument, BusValue& value) {
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  std::int64_t time = -1;
  if (const auto* whole = std::get_if<std::int64_t>(&argument)) time = *whole;
  if (const auto* whole = std::get_if<std::uint64_t>(&argument)) {
    time = *whole <= static_cast<std::uint64_t>(kMost) ? static_cast<std::int64_t>(*whole) : -1;
  }
  if (time < 0) return fail(Errc::bad_value, "time: is no UTC in whole nanoseconds", "tell 0 for now");
  if (time > 0) value.time = time;
  return Done{};
}

Status read_quality(const BusArgument& argument, BusValue& value) {
  const auto* text = std::get_if<std::string>(&argument);
  if (text == nullptr) return fail(Errc::bad_value, "quality: is no text", "tell good, stale or bad");
  // A word of the feeder's own that is not "good" is a doubt.
  value.quality = text->empty() || *text == "good" ? "good" : *text == "stale" ? "stale" : "bad";
  return Done{};
}

}  // namespace

Result<BusValue> read_bus_value(const std::vector<BusArgument>& arguments) {
  if (arguments.empty()) return fail(Errc::missing, "the signal has no value", "tell a number or a text");
  BusValue value;
  using Read = Status (*)(const BusArgument&, BusValue&);
  constexpr Read kReads[] = {read_value, read_unit, read_time, read_quality};
  for (std::size_t i = 0; i < std::min(arguments.size(), std::size(kReads)); ++i) {
    if (Status read = kReads[i](arguments[i], value); !read) return read.error();
  }
  return value;
}

std::optional<std::string> sensor_of(std::string_view path, std::string_view interface) {
  if (!path.starts_with(kPath) || !interface.starts_with(kInterface)) return std::nullopt;
  const std::string_view name = path.substr(kPath.size());
  if (name != interface.substr(kInterface.size()) || !is_sensor_name(name)) return std::nullopt;
  return std::string(name);
}

std::string to_sensor_name(std::string_view wish) {
  constexpr std::size_t kRoomForNumber = 5;
  std::string name(wish.substr(0, kMaxName - kRoomForNumber));
  for (char& c : name) {
    if (!is_letter(c) && !is_digit(c)) c = '_';
  }
  if (name.empty() || !is_letter(name.front())) name.insert(0, "_");
  return name.substr(0, kMaxName - kRoomForNumber);
}

}  // namespace trb::sensor
