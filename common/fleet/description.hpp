// A robot's description, config/robots/*.json: what it can do, in which units, and how each skill ends.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/fleet/fault_rule.hpp"
#include "common/fleet/places.hpp"
#include "proto/bodies/link.hpp"
#include "proto/value.hpp"

namespace trb {

enum class ParameterType : std::uint8_t { number = 0, integer, text, boolean, place, numbers };
constexpr auto enum_names(ParameterType) {
  return std::array<std::string_view, 6>{"number", "integer", "text", "bool", "place", "numbers"};
}

/// A typed parameter of a skill. Numbers are in SI units; the description's units turn them into the vendor's.
struct Parameter {
  std::string name;
  ParameterType type{};
  bool required = true;
  std::string unit;  ///< "m", "rad", "s", "m/s" … or empty
  std::optional<double> minimum;
  std::optional<double> maximum;
  std::vector<std::string> one_of;   ///< for text and place: the words allowed; empty: any
  std::optional<std::size_t> count;  ///< for numbers: how many
  std::optional<Value> preset;       ///< used when an optional parameter is not given
};

/// How a skill is known to have ended.
enum class EndKind : std::uint8_t { acknowledgement = 0, state, position, time };
constexpr auto enum_names(EndKind) {
  return std::array<std::string_view, 4>{"acknowledgement", "state", "position", "time"};
}

struct SkillEnd {
  EndKind kind{};
  std::string
      state;  ///< kind state: a name that the monitor reports; kind position: likewise, empty: "position" or "joints"
  double equals = 0;                              ///< kind state: the value to wait for
  double tolerance = 0.01;                        ///< kind position: how near to the target, in the monitor's unit
  std::string target;                             ///< kind position: the parameter that holds the target
  double duration_s = 0;                          ///< kind time
  std::optional<double> fails_at = std::nullopt;  ///< kind state: the value that means that the skill has failed
};

/// An action already implemented on the robot. It is sent as a command of `subtype` whose data is `data` with its
/// placeholders filled: {NAME} a parameter, {NAME.x|y|z|yaw} a coordinate of a place in the robot's frame and units,
/// {NAME.qz|qw} its yaw as a quaternion (ROS REP-103).
struct Skill {
  std::string name;
  std::string capability;
  std::vector<Parameter> parameters;
  std::string subtype;
  std::string data;
  SkillEnd end;
  double timeout_s = 60;
  bool repeatable = false;
};

/// An axis that a person drives: a speed in m/s or rad/s.
struct DriveAxis {
  std::string name;
  double limit = 0;              ///< the highest speed
  bool one_way = false;          ///< it has no other direction: a speed under 0 counts as 0
  std::optional<double> factor;  ///< the robot's number for 1 m/s or 1 rad/s; none: as `frame` says
};

/// A part of the robot that can be driven by hand (Velocity). Its command's data has a placeholder for each axis.
struct Drive {
  DrivePart part{};
  std::vector<DriveAxis> axes;
  Skill command;               ///< its parameters are the axes; it has no end
  std::optional<Skill> stand;  ///< how it is told to stand; none: by the command, all speeds 0

  [[nodiscard]] DriveInfo info() const;
};

enum class Framing : std::uint8_t { newline = 0, length, delay };
constexpr auto enum_names(Framing) {
  return std::array<std::string_view, 3>{"newline", "length", "delay"};
}
enum class Encoding : std::uint8_t { text = 0, numeric };
constexpr auto enum_names(Encoding) {
  return std::array<std::string_view, 2>{"text", "numeric"};
}

/// The settings of proto/FIELD_CHANNEL.md.
struct FieldChannel {
  Framing framing{};
  Encoding encoding{};
  bool acknowledge = true;
  double ack_timeout_s = 2;
  std::uint32_t chunk_bytes = 0;
  double delay_s = 0.002;
  std::map<std::string, std::int64_t> subtype_codes;
  std::map<std::string, std::int64_t> id_codes;
};

/// How the robot's units and frame relate to the hall's (metres, radians).
struct RobotFrame {
  double length = 1;  ///< vendor units a metre: 1000 for mm
  double angle = 1;   ///< vendor units a radian: 57.29577951308232 for degrees
  Pose origin;        ///< the robot's origin in the hall's frame

  /// Vendor units per SI unit: for metres and units per metre, radians alike; other units are the same everywhere.
  [[nodiscard]] double factor_of(std::string_view unit) const {
    if (unit == "m" || unit.starts_with("m/")) return length;
    return unit == "rad" || unit.starts_with("rad/") ? angle : 1;
  }
};

struct Description {
  std::string maker;
  std::string model;
  std::vector<std::string> capabilities;
  std::vector<Skill> skills;
  std::vector<Drive> drives;  ///< one of a part
  RobotFrame frame;
  std::map<std::string, Value>
      places;  ///< the robot's own terms for a place (joints, a station's number); take precedence over the pose
  std::vector<FaultRule> faults;
  std::vector<NamedNumber> numbers;  ///< what a person or a ranking may want to know, such as payload and reach
  std::vector<std::string> sensors;  ///< values that are sent to the fleet when they change (RobotState)
  FieldChannel field_channel;
  bool has_field_channel = false;  ///< the file has that key: the robot can use the field channel, whatever its mode

  [[nodiscard]] const Skill* find_skill(std::string_view name) const;
  [[nodiscard]] const Drive* find_drive(DrivePart part) const;
};

/// Reads a description; every fault is added to `faults`, and reading continues. Skills without an end, of an unknown
/// capability, with placeholders that name no parameter, or with the same name twice are faults.
Description read_description(const Value& json, const std::string& file, ConfigFaults& faults);

/// The part of a description that is sent to the fleet.
std::vector<SkillInfo> skill_infos(const Description& description);

/// The places that the robot can be sent to: the hall's and those that its description defines, sorted
/// (NodeProfile::places).
std::vector<std::string> place_names(const Description& description, const Places& places);

}  // namespace trb
