// Conditions of tasks: described as text, and evaluated on a sensor's reading.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "common/base/result.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// Checks what can be checked without a fleet. Errors: bad_value.
Status check_condition(const Condition& condition);

/// What all conditions that can be evaluated on one reading have in common.
inline auto source_of(const Condition& condition) {
  return std::tie(condition.sensor, condition.of, condition.identity, condition.is_text, condition.unit);
}

/// The sensor of a node that the condition refers to, or nullptr: by its serial number, else by its name, else by its
/// kind (of several the first by name, those that are ok first).
const SensorInfo* find_sensor(const std::vector<SensorInfo>& plugged, const Condition& condition);

/// May the condition be evaluated on this reading? Error, readable for a person: bad_value (a text instead of a number,
/// another unit, a value that is stale or bad).
Status believe(const Condition& condition, const SensorReading& reading);

/// Evaluates the condition on a reading that believe() accepts.
bool holds(const Condition& condition, const SensorReading& reading);

/// "temperature of conveyor", "temperature of any node", "temperature with serial number 28-01".
std::string sensor_text(const Condition& condition);
/// "temperature of conveyor > 20 degC".
std::string condition_text(const Condition& condition);
/// "temperature of conveyor was 25.1 degC, not <= 20"; `node` is where it was read.
std::string verdict_text(const Condition& condition, const std::string& node, const SensorReading& reading);

}  // namespace trb
