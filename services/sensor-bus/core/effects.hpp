// What the core wants of the D-Bus and of the devices, as values; and what the bus reports.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "proto/bodies/sensor.hpp"
#include "services/sensor-bus/core/bus_value.hpp"

namespace trb::sensor {

// ---- to the bus. While it is down the core orders nothing: on BusUp it orders everything again.

/// The object /trbots/NAME with interface trbots.NAME is there, for introspection; again: it has changed.
struct Announce {
  SensorInfo info;
  bool is_text = false;  ///< its values are texts
};
struct Withdraw {
  std::string name;
};
/// A match rule for the signal `value` of trbots.NAME alone.
struct Subscribe {
  std::string name;
};
struct Unsubscribe {
  std::string name;
};
struct EmitValue {
  std::string name;
  BusValue value;
};

// ---- to the devices: see DeviceControl

struct ReadNow {
  std::string key;
};
struct TakePicture {
  std::string key;
};

using Effect = std::variant<Announce, Withdraw, Subscribe, Unsubscribe, EmitValue, ReadNow, TakePicture>;

// ---- of the bus

struct BusUp {
  std::string note;  ///< what is not as it should be
};
struct BusDown {
  std::string reason;
};
/// A signal that was subscribed to.
struct SignalHeard {
  std::string name;
  bool own = false;  ///< this service has emitted it
  BusValue value;
};
/// Another program has emitted a value of that name; it was not read.
struct ProgramHeard {
  std::string name;
};
/// A signal that cannot be taken.
struct SignalRefused {
  std::string counter;  ///< "refused.signal_…"
  std::string text;
};

using BusEvent = std::variant<BusUp, BusDown, SignalHeard, ProgramHeard, SignalRefused>;

}  // namespace trb::sensor
