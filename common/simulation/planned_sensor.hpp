// A sensor of a simulated fleet: what its node tells of it, and its value over time.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "proto/bodies/sensor.hpp"

namespace trb::simulation {

/// A number or a text; `std::monostate`: it cannot be read.
using Measured = std::variant<std::monostate, double, std::string>;

/// A value over time, in seconds from the run's submission; before that it is as at 0.
class Course {
 public:
  struct Step {
    double at_s = 0;
    Measured value;
  };

  Course() = default;
  /// From each step's time on its value; before the first one the first one's.
  explicit Course(std::vector<Step> steps) : steps_(std::move(steps)) {}
  /// From `begin_s` to `end_s` evenly from one number to the other; before and after it stays.
  static Course ramp(double from, double to, double begin_s, double end_s) {
    Course out({{begin_s, from}, {end_s, to}});
    out.is_ramp_ = true;
    return out;
  }

  [[nodiscard]] Measured at(double seconds) const;
  /// Is it ever a text, or else a number? One that can never be read is both.
  [[nodiscard]] bool tells(bool text) const;
  /// Steps, and a ramp's begin and end, that come later.
  struct Late {
    double at_s = 0;  ///< the first of them
    std::size_t steps = 0;
  };
  [[nodiscard]] std::optional<Late> after(double seconds) const;
  /// From then on it stays as it is.
  [[nodiscard]] double end_s() const { return steps_.empty() ? 0 : steps_.back().at_s; }

 private:
  std::vector<Step> steps_;  ///< in order of time
  bool is_ramp_ = false;
};

struct PlannedSensor {
  std::string node;
  SensorInfo info;
  double every_s = 1;  ///< how often it is read
  Course course;
};

}  // namespace trb::simulation
