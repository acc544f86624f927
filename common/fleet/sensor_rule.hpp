// A rule of sensors/*.json: which devices it matches, which sensors they have and how each is read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/fleet/line_pattern.hpp"
#include "common/fleet/reader_kind.hpp"
#include "proto/field.hpp"
#include "proto/value.hpp"

namespace trb {

/// The values of an NMEA receiver. position: "LATITUDE,LONGITUDE" as text; speed in m/s, altitude in m, the rest in
/// degrees.
enum class NmeaValue : std::uint8_t { position = 0, latitude, longitude, altitude, speed, course, satellites };
constexpr auto enum_names(NmeaValue) {
  return std::array<std::string_view, 7>{"position", "latitude", "longitude", "altitude",
                                         "speed",    "course",   "satellites"};
}

/// A property or attribute and its allowed values: any of the patterns, each with '*' and '?'.
struct TextMatch {
  std::string name;
  std::vector<std::string> any_of;
};

/// All of it must match; an empty text always matches.
struct DeviceMatch {
  std::string subsystem;
  std::string devtype;
  std::vector<std::string> sysname;  ///< any of these patterns
  std::vector<TextMatch> properties;
  std::vector<TextMatch> attributes;

  /// How specific it is: of several rules that match a device, the most specific is taken.
  [[nodiscard]] std::size_t conditions() const;
};

/// One sensor of a device.
struct SensorChannel {
  std::string name;
  std::string kind;
  std::string unit;
  double every_s = 1;  ///< 0: it sends a value when there is one, as a tag reader does
  double scale = 1;    ///< the value is the reading * scale + offset
  double offset = 0;
  std::string attribute;  ///< attributes: a file; with '*' a sensor for each existing one
  std::string channel;    ///< attributes: "in_temp": in_temp_input, else (in_temp_raw + in_temp_offset) * in_temp_scale
  NmeaValue nmea{};       ///< nmea
  std::optional<LinePattern> pattern;  ///< line
  std::optional<std::size_t> field;    ///< line: the number of a field, from 1; neither: the whole line
  bool is_text = false;                ///< line: the value is a text
};

/// Where the serial number is read from. If none of these exists, the sensor has no identity.
struct IdentitySource {
  bool is_property = false;
  std::string name;
};

struct SensorRule {
  std::string file;                  ///< the rule's file: "sensors/gps.json"
  std::vector<DeviceMatch> matches;  ///< any of them
  ReadBy by{};
  double timeout_s = 0;       ///< a reading that takes longer has failed
  std::uint32_t baud = 9600;  ///< nmea, line
  char separator = ',';       ///< line: between its fields
  std::uint32_t width = 640;  ///< camera
  std::uint32_t height = 480;
  std::optional<IdentitySource> identity;
  std::vector<SensorChannel> channels;
};

/// A rule's file. Every fault is reported; the result is usable only if there is none.
SensorRule read_sensor_rule(const Value& json, const std::string& file, ConfigFaults& faults);

/// The baud rates that a rule may name.
const std::vector<std::int64_t>& serial_speeds();

}  // namespace trb
