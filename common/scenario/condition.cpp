#include "common/scenario/condition.hpp"

#include <algorithm>
#include <charconv>
#include <tuple>

namespace trb {
namespace {

bool is_order(Comparison op) {
  return op != Comparison::equal && op != Comparison::unequal;
}

/// The shortest text that is read back as the same number.
std::string exact_text(double number) {
  char out[32];
  const auto end = std::to_chars(out, out + sizeof out, number).ptr;
  return {out, static_cast<std::size_t>(end - out)};
}

std::string with_unit(const std::string& value, const std::string& unit) {
  return unit.empty() ? value : value + " " + unit;
}

std::string wanted_text(const Condition& condition) {
  return condition.is_text ? "'" + condition.text + "'" : exact_text(condition.number);
}

template <class Value>
bool compare(Comparison op, const Value& left, const Value& right) {
  switch (op) {
    case Comparison::less:
      return left < right;
    case Comparison::at_most:
      return left <= right;
    case Comparison::more:
      return left > right;
    case Comparison::at_least:
      return left >= right;
    case Comparison::equal:
      return left == right;
    case Comparison::unequal:
      return left != right;
  }
  return false;
}

/// Smaller is the better choice.
auto rank(const SensorInfo& info) {
  return std::tuple(info.state != SensorState::ok, std::string_view(info.name));
}

}  // namespace

Status check_condition(const Condition& condition) {
  if (condition.sensor.empty()) return fail(Errc::bad_value, "when: names no sensor");
  if (condition.is_text && is_order(condition.op)) {
    return fail(Errc::bad_value, "when: a text is compared with '" + std::string(name_of(condition.op)) + "'",
                "use == or !=");
  }
  return Done{};
}

const SensorInfo* find_sensor(const std::vector<SensorInfo>& plugged, const Condition& condition) {
  const SensorInfo* best = nullptr;
  for (const SensorInfo& info : plugged) {
    if (!condition.identity.empty()) {
      if (info.identity != condition.identity) continue;
    } else if (info.name == condition.sensor) {
      return &info;
    } else if (info.kind != condition.sensor) {
      continue;
    }
    if (best == nullptr || rank(info) < rank(*best)) best = &info;
  }
  return best;
}

Status believe(const Condition& condition, const SensorReading& reading) {
  if (reading.quality != "good") return fail(Errc::bad_value, "its value is '" + reading.quality + "'");
  if (reading.is_text != condition.is_text) {
    return fail(Errc::bad_value, condition.is_text ? "it tells a number, not a text" : "it tells a text, not a number");
  }
  if (!reading.is_text && reading.unit != condition.unit) {
    return fail(Errc::bad_value, "its unit is '" + reading.unit + "', not '" + condition.unit + "'");
  }
  return Done{};
}

bool holds(const Condition& condition, const SensorReading& reading) {
  return condition.is_text ? compare(condition.op, reading.text, condition.text)
                           : compare(condition.op, reading.number, condition.number);
}

std::string sensor_text(const Condition& condition) {
  if (!condition.identity.empty()) return condition.sensor + " with serial number " + condition.identity;
  return condition.sensor + " of " + (condition.of.empty() ? "any node" : condition.of);
}

std::string condition_text(const Condition& condition) {
  return sensor_text(condition) + " " + std::string(name_of(condition.op)) + " " +
         with_unit(wanted_text(condition), condition.is_text ? "" : condition.unit);
}

std::string verdict_text(const Condition& condition, const std::string& node, const SensorReading& reading) {
  const std::string value = reading.is_text ? "'" + reading.text + "'" : exact_text(reading.number);
  return reading.sensor + " of " + node + " was " + with_unit(value, reading.unit) +
         (holds(condition, reading) ? ", " : ", not ") + std::string(name_of(condition.op)) + " " +
         wanted_text(condition);
}

}  // namespace trb
