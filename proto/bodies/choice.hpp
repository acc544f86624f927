// Conditions of tasks, and the signed record of how they were evaluated.
#pragma once

#include "proto/bodies/sensor.hpp"
#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

enum class Comparison : std::uint8_t { less = 0, at_most, more, at_least, equal, unequal };
constexpr auto enum_names(Comparison) {
  return std::array<std::string_view, 6>{"<", "<=", ">", ">=", "==", "!="};
}

/// A task's `when`: the task is SKIPPED unless the comparison with the sensor's value holds. Other kinds of condition
/// come as fields of their own; this one has a `sensor`.
struct Condition {
  std::string sensor;    ///< its name, or else its kind, as in SensorRead
  std::string of;        ///< the node that has it; empty: any
  std::string identity;  ///< its serial number; takes precedence over `of`
  Comparison op{};
  bool is_text = false;  ///< compared with `text`, else with `number`
  double number = 0;
  std::string text;
  std::string unit;  ///< of a number: a value in another unit is not accepted
  bool operator==(const Condition&) const = default;
  template <class T = Condition>
  static FieldTable fields() {
    return FieldTable{field("sensor", &T::sensor, 64),      field("of", &T::of, 64),
                      field("identity", &T::identity, 128), field("op", &T::op),
                      field("is_text", &T::is_text),        field("number", &T::number),
                      field("text", &T::text, 1024),        field("unit", &T::unit, 16)};
  }
};

/// What was chosen for one task.
struct ChosenTask {
  std::string task;
  std::uint32_t iteration = 1;
  bool holds = false;  ///< whether the condition holds; if not, the task is SKIPPED
  bool operator==(const ChosenTask&) const = default;
  template <class T = ChosenTask>
  static FieldTable fields() {
    return FieldTable{field("task", &T::task, 64), field("iteration", &T::iteration), field("holds", &T::holds)};
  }
};

/// Conditions evaluated once, from one reading, signed by the node that evaluated them (purpose "choice"): the actor of
/// the tasks' lowest-numbered predecessor, or a task's own actor if it has none. All other nodes follow it.
struct Choice {
  static constexpr std::string_view kSubtype = "choice";
  static constexpr Travel kTravel = in_record();
  std::string run;
  Blob digest;
  std::uint32_t epoch = 1;
  std::string by;
  std::vector<ChosenTask> tasks;
  std::string node;       ///< that sent the value
  SensorReading reading;  ///< the value
  std::int64_t time = 0;  ///< when the choice was made: UTC ns
  bool operator==(const Choice&) const = default;
  template <class T = Choice>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64),     field("digest", &T::digest, 32), field("epoch", &T::epoch),
                      field("by", &T::by, 64),       field("tasks", &T::tasks, 1000), field("node", &T::node, 64),
                      field("reading", &T::reading), field("time", &T::time)};
  }
};

}  // namespace trb
