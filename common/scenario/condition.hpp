// Conditions of tasks: told in words, and compared with what a sensor says.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "common/base/result.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// Checks what can be checked without a fleet. Errors: bad_value.
Status check_condition(const Condition& condition);

/// What conditions have in common that can be evaluated over one reading.
inline auto source_of(const Condition& condition) {
  return std::tie(condition.sensor, condition.of, condition.identity, condition.is_text, condition.unit);
}

/// The one of a node's sensors that the condition speaks of, or nullptr: by its serial number, else by its name, else
/// by its kind (of several the first by name, those that are ok before the others).
const SensorInfo* find_sensor(const std::vector<SensorInfo>& plugged, const Condition& condition);

/// May the condition be evaluated over this reading? Error, in a person's words: bad_value (a text for a number,
/// another unit, a value that is stale or doubted).
Status believe(const Condition& condition, const SensorReading& reading);

/// The condition over a reading that is believed.
bool holds(const Condition& condition, const SensorReading& reading);

/// "temperature of conveyor", "temperature of any node", "temperature with serial number 28-01".
std::string sensor_text(const Condition& condition);
/// "temperature of conveyor > 20 degC".
std::string condition_text(const Condition& condition);
/// "temperature of conveyor was 25.1 degC, not <= 20"; `node` is where it was read.
std::string verdict_text(const Condition& condition, const std::string& node, const SensorReading& reading);

}  // namespace trb
