// What people do with an alert as an alarm (IEC 62682, EEMUA 191).
#pragma once

#include <cstdint>
#include <string>

#include "common/base/time.hpp"
#include "proto/bodies/resilience.hpp"

namespace trb::gateway {

/// Of one alert, as clients see it.
struct Alarm {
  std::uint32_t priority = 4;   ///< 1 (FATAL) to 4 (WARNING)
  std::string source;           ///< what alarms: an alarm that comes again has the same
  std::string acknowledged_by;  ///< empty: by nobody
  UtcTime acknowledged{};
  std::string shelved_by;  ///< empty: not shelved
  std::string shelved_why;
  UtcTime shelved{};
  UtcTime shelved_until{};
  bool chatters = false;
  std::uint32_t times = 1;  ///< of one that chatters: how often it came
  std::string first;        ///< the alert that this one probably follows from; empty: none
  bool operator==(const Alarm&) const = default;
};

/// An alert that somebody has seen. A higher severity is to be seen anew.
struct Acknowledgement {
  std::string alert;
  std::string by;
  UtcTime at;
  Severity severity{};
  bool operator==(const Acknowledgement&) const = default;
};

/// A source of alarms that somebody has put aside for a while, also for alerts that come later.
struct Shelf {
  std::string source;
  std::string by;
  UtcTime at;
  UtcTime until;
  std::string why;
  bool operator==(const Shelf&) const = default;
};

/// What alarms: the robot and what it has lost, or the run, and the cause.
std::string source_of(const Alert& alert);
std::uint32_t priority_of(Severity severity);
/// It waits for a person, or for a robot.
bool is_open(const Alert& alert);

}  // namespace trb::gateway
