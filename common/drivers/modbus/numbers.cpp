// Converts numbers to a Modbus device's registers and back.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/drivers/modbus/syntax.hpp"

namespace trb::drivers {
namespace {

struct Bounds {
  double from;
  double to;
};

Bounds bounds_of(ModbusType type) {
  switch (type) {
    case ModbusType::boolean:
      return {0, 1};
    case ModbusType::int16:
      return {-32768, 32767};
    case ModbusType::uint16:
      return {0, 65535};
    case ModbusType::int32:
      return {-2147483648.0, 2147483647.0};
    case ModbusType::uint32:
      return {0, 4294967295.0};
    case ModbusType::float32:
      break;
  }
  constexpr double kLargest = std::numeric_limits<float>::max();
  return {-kLargest, kLargest};
}

std::string text_of(double number) {
  std::array<char, 40> text{};
  const int size = std::snprintf(text.data(), text.size(), "%.10g", number);
  return {text.data(), static_cast<std::size_t>(size)};
}

std::string range_text(const ModbusPlace& place) {
  const Bounds raw = bounds_of(place.type);
  double from = raw.from * place.factor + place.offset;
  double to = raw.to * place.factor + place.offset;
  if (to < from) std::swap(from, to);
  return text_of(from) + " to " + text_of(to);
}

/// The number as in the registers: unscaled, and whole unless it is a float.
Result<double> raw_of(const ModbusPlace& place, double number) {
  const std::string type(name_of(place.type));
  double raw = (number - place.offset) / place.factor;
  if (place.type != ModbusType::float32) {
    const double whole = std::nearbyint(raw);
    const bool scaled = place.factor != 1;
    if (!scaled && whole != raw) {
      const bool bit = place.type == ModbusType::boolean;
      return fail(Errc::bad_value, text_of(number) + " is no whole number, which " + to_text(place) + " takes alone",
                  bit ? "give true, false, 1 or 0" : "round it, or give the value a factor in commands.json");
    }
    raw = whole;
  }
  const Bounds bounds = bounds_of(place.type);
  if (raw >= bounds.from && raw <= bounds.to) return raw;
  return fail(Errc::bad_value, text_of(number) + " does not fit " + to_text(place) + ", a " + type,
              place.type == ModbusType::boolean ? "give true, false, 1 or 0" : "give " + range_text(place));
}

std::uint32_t bits_of(const ModbusPlace& place, double raw) {
  if (place.type == ModbusType::float32) return std::bit_cast<std::uint32_t>(static_cast<float>(raw));
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(raw));
}

/// 0.1 as a float is 0.100000001…; a person means 0.1.
double shortest(float number) {
  std::array<char, 64> text{};
  const auto [end, ignored] = std::to_chars(text.data(), text.data() + text.size(), number);
  double out = 0;
  std::from_chars(text.data(), end, out);
  return out;
}

double raw_number(ModbusType type, std::uint32_t bits) {
  switch (type) {
    case ModbusType::boolean:
      return bits == 0 ? 0 : 1;
    case ModbusType::int16:
      return static_cast<std::int16_t>(bits);
    case ModbusType::int32:
      return static_cast<std::int32_t>(bits);
    case ModbusType::uint16:
    case ModbusType::uint32:
      return bits;
    case ModbusType::float32:
      break;
  }
  return shortest(std::bit_cast<float>(bits));
}

}  // namespace

Result<std::vector<std::uint16_t>> modbus_words(const ModbusPlace& place, double number) {
  const auto raw = raw_of(place, number);
  if (!raw) return raw.error();
  const std::uint32_t bits = bits_of(place, *raw);
  const auto low = static_cast<std::uint16_t>(bits & 0xffffU);
  const auto high = static_cast<std::uint16_t>(bits >> 16U);
  if (place.size() == 1) return std::vector<std::uint16_t>{low};
  return place.low_word_first ? std::vector{low, high} : std::vector{high, low};
}

Status modbus_holds(const ModbusPlace& place, double number) {
  const double raw = (number - place.offset) / place.factor;
  const double whole = place.type == ModbusType::float32 ? raw : std::nearbyint(raw);
  const Bounds bounds = bounds_of(place.type);
  if (whole >= bounds.from && whole <= bounds.to) return Done{};
  return fail(Errc::bad_value,
              text_of(number) + " does not fit " + to_text(place) + ", a " + std::string(name_of(place.type)),
              place.type == ModbusType::boolean ? "give true, false, 1 or 0" : "give " + range_text(place));
}

Status modbus_has(const ModbusPlace& place, double number) {
  if (Status held = modbus_holds(place, number); !held || place.type == ModbusType::float32) return held;
  const double raw = (number - place.offset) / place.factor;
  const auto told = [&](double whole) { return whole * place.factor + place.offset; };
  constexpr double kSame = 1e-9;
  if (std::abs(told(std::nearbyint(raw)) - number) < kSame) return Done{};
  return fail(
      Errc::bad_value,
      text_of(number) + " lies between two numbers of " + to_text(place) + ", a " + std::string(name_of(place.type)),
      "give " + text_of(told(std::floor(raw))) + " or " + text_of(told(std::ceil(raw))));
}

Status modbus_passes(const ModbusPlace& place, double number, bool above) {
  const Bounds raw = bounds_of(place.type);
  const double one = raw.from * place.factor + place.offset;
  const double other = raw.to * place.factor + place.offset;
  if (above ? number < std::max(one, other) : number > std::min(one, other)) return Done{};
  return fail(Errc::bad_value, to_text(place) + " is " + range_text(place), "give a limit within that");
}

Result<double> modbus_number(const ModbusPlace& place, const std::vector<std::uint16_t>& words) {
  if (words.size() != place.size()) return fail(Errc::bad_value, "the answer has another size than asked for");
  const bool swapped = place.low_word_first && words.size() == 2;
  std::uint32_t bits = swapped ? words.back() : words.front();
  if (words.size() == 2) bits = bits << 16U | (swapped ? words.front() : words.back());
  if (place.type == ModbusType::float32 && !std::isfinite(std::bit_cast<float>(bits))) {
    return fail(Errc::bad_value, to_text(place) + " holds a float32 that is no number",
                "look at the PLC's program, and whether its words are in the other order (low_word_first)");
  }
  return raw_number(place.type, bits) * place.factor + place.offset;
}

}  // namespace trb::drivers
