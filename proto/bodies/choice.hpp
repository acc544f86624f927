// Conditions of tasks, and the signed record of what one came to.
#pragma once

#include "proto/bodies/sensor.hpp"
#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

enum class Comparison : std::uint8_t { less = 0, at_most, more, at_least, equal, unequal };
constexpr auto enum_names(Comparison) {
  return std::array<std::string_view, 6>{"<", "<=", ">", ">=", "==", "!="};
}

/// A task's `when`: it is SKIPPED unless the sensor's value compares so. Other kinds of condition come as fields of
/// their own; this one has a `sensor`.
struct Condition {
  std::string sensor;    ///< its name, else its kind: as in SensorRead
  std::string of;        ///< the node that has it; empty: any
  std::string identity;  ///< its serial number; wins over `of`
  Comparison op{};
  bool is_text = false;  ///< compared with `text`, else with `number`
  double number = 0;
  std::string text;
  std::string unit;  ///< a number's: a value in another unit is not taken
  bool operator==(const Condition&) const = default;
  template <class T = Condition>
  static FieldTable fields() {
    return FieldTable{field("sensor", &T::sensor, 64),      field("of", &T::of, 64),
                      field("identity", &T::identity, 128), field("op", &T::op),
                      field("is_text", &T::is_text),        field("number", &T::number),
                      field("text", &T::text, 1024),        field("unit", &T::unit, 16)};
  }
};

/// What the choice is for one task.
struct ChosenTask {
  std::string task;
  std::uint32_t iteration = 1;
  bool holds = false;  ///< the condition: else the task is SKIPPED
  bool operator==(const ChosenTask&) const = default;
  template <class T = ChosenTask>
  static FieldTable fields() {
    return FieldTable{field("task", &T::task, 64), field("iteration", &T::iteration), field("holds", &T::holds)};
  }
};

/// Conditions evaluated once, over one reading, signed by the node that evaluated them (purpose "choice"): the actor of
/// the tasks' lowest-numbered predecessor, or a task's own if it has none. Everybody else goes by it.
struct Choice {
  static constexpr std::string_view kSubtype = "choice";
  static constexpr Travel kTravel = in_record();
  std::string run;
  Blob digest;
  std::uint32_t epoch = 1;
  std::string by;
  std::vector<ChosenTask> tasks;
  std::string node;       ///< that told the value
  SensorReading reading;  ///< the value
  std::int64_t time = 0;  ///< of the choice: UTC ns
  bool operator==(const Choice&) const = default;
  template <class T = Choice>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64),     field("digest", &T::digest, 32), field("epoch", &T::epoch),
                      field("by", &T::by, 64),       field("tasks", &T::tasks, 1000), field("node", &T::node, 64),
                      field("reading", &T::reading), field("time", &T::time)};
  }
};

}  // namespace trb
