// The seam between the core and the devices: what udev and the readers report, and what they are to do.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/sensor.hpp"

namespace trb::sensor {

/// A sensor that a rule has found in a device; a device may have several, as temperature and humidity.
struct PluggedSensor {
  std::string key;     ///< "SYSPATH#CHANNEL", unique while it is plugged in
  SensorInfo info;     ///< its name as the rule wishes it: the core makes it unique
  double every_s = 1;  ///< its period; 0: it has none, and sends when it has something to send
};

/// What a reader has read, or that it could not.
struct Sample {
  std::string key;
  bool is_text = false;
  double number = 0;
  std::string text;
  UtcTime time;                ///< of the measurement
  MonotonicTime measured;      ///< the same moment
  std::optional<Error> error;  ///< missing: nothing is wrong with it, but it has no value, as a GPS without a fix
};

/// A picture, or why there is none.
struct Picture {
  std::string key;
  std::string media_type;
  UtcTime time;
  Bytes bytes;
  std::optional<Error> error;
};

/// Told on the loop's thread, as steps of the core.
class DeviceListener {
 public:
  virtual ~DeviceListener() = default;
  virtual void on_plugged(const PluggedSensor& sensor) = 0;
  virtual void on_unplugged(const std::string& key) = 0;
  virtual void on_sample(const Sample& sample) = 0;
  virtual void on_picture(const Picture& picture) = 0;
  /// Every device that no rule knows, at each change.
  virtual void on_unknown(const std::vector<UnknownDevice>& devices) = 0;
};

/// What the core wants of the devices. Neither waits.
class DeviceControl {
 public:
  virtual ~DeviceControl() = default;
  /// Read it at once, not at the end of its period; its Sample follows.
  virtual void read_now(const std::string& key) = 0;
  /// Its Picture follows.
  virtual void take_picture(const std::string& key) = 0;
};

}  // namespace trb::sensor
