// Bodies about sensors that are plugged into a node's PC: published, requested, streamed.
#pragma once

#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

/// ok: it sends values. silent: none for three of its periods. failed: its reader fails or hangs. unread: it is
/// present, but nothing has been read from it yet.
enum class SensorState : std::uint8_t { unread = 0, ok, silent, failed };
constexpr auto enum_names(SensorState) {
  return std::array<std::string_view, 4>{"unread", "ok", "silent", "failed"};
}

/// A sensor as the fleet knows it.
struct SensorInfo {
  std::string name;      ///< [A-Za-z_][A-Za-z0-9_]*, unique at its node: the D-Bus interface is trbots.NAME
  std::string kind;      ///< "temperature", "humidity", "position", "tag", "image" …: the capability that it adds
  std::string unit;      ///< "degC", "percent", "V", "m" …; empty for none
  std::string identity;  ///< its serial number, the same wherever it is plugged in; empty: it has none
  std::string device;    ///< maker and model, or the program that provides it, for people
  SensorState state{};
  std::string detail;  ///< why, when not ok
  bool operator==(const SensorInfo&) const = default;
  template <class T = SensorInfo>
  static FieldTable fields() {
    return FieldTable{field("name", &T::name, 64),      field("kind", &T::kind, 64),
                      field("unit", &T::unit, 16),      field("identity", &T::identity, 128),
                      field("device", &T::device, 128), field("state", &T::state),
                      field("detail", &T::detail, 255)};
  }
};

/// Sensor-bus -> router: every sensor of the node, at its start and at each change. The router publishes it in the
/// node's profile, and forwards requests whose subtype is a sensor's name to the sensor-bus.
struct NodeSensors {
  static constexpr std::string_view kSubtype = "node_sensors";
  static constexpr Travel kTravel = on_bus(CostPhase::devices, {"sensor-bus"});
  std::vector<SensorInfo> sensors;
  template <class T = NodeSensors>
  static FieldTable fields() {
    return FieldTable{field("sensors", &T::sensors, 255)};
  }
};

/// To a node's sensor-bus (request): the sensor's next value. Answered by SensorReading or a Nack (unknown_target: no
/// such sensor; timeout; robot_error: the text of its reader).
struct SensorRead {
  static constexpr std::string_view kSubtype = "sensor_read";
  static constexpr Travel kTravel = between_nodes(CostPhase::sensor);
  std::string sensor;    ///< a sensor's name; or else a kind, if exactly one sensor of the node has it
  std::string identity;  ///< takes precedence over `sensor`
  double timeout_s = 0;  ///< 0: three of its periods, 3 s at least
  template <class T = SensorRead>
  static FieldTable fields() {
    return FieldTable{field("sensor", &T::sensor, 64), field("identity", &T::identity, 128),
                      field("timeout_s", &T::timeout_s)};
  }
};

/// To a node's sensor-bus (request): a stream of values. Answered by Ack "accepted", then by a SensorReading for each
/// value, on the lossy lane, until the lease has expired or the requester is gone. A SensorWatch by the same requester,
/// with the same sensor and `watch`, renews the lease, or, with a lease of 0, ends it.
struct SensorWatch {
  static constexpr std::string_view kSubtype = "sensor_watch";
  static constexpr Travel kTravel = between_nodes(CostPhase::sensor);
  std::string sensor;
  std::string identity;     ///< takes precedence over `sensor`
  std::uint64_t watch = 0;  ///< the requester's number for it
  double every_s = 1;       ///< 0.01 at least; never more often than the sensor sends values
  double lease_s = 10;      ///< 60 at most
  template <class T = SensorWatch>
  static FieldTable fields() {
    return FieldTable{field("sensor", &T::sensor, 64), field("identity", &T::identity, 128), field("watch", &T::watch),
                      field("every_s", &T::every_s), field("lease_s", &T::lease_s)};
  }
};

/// A measured value. Numbers are in SI units, temperatures in degC.
struct SensorReading {
  static constexpr std::string_view kSubtype = "sensor_reading";
  static constexpr Travel kTravel = between_nodes(CostPhase::sensor);
  std::string sensor;
  std::string identity;
  std::string unit;
  bool is_text = false;  ///< `text` is the value, else `number`
  double number = 0;
  std::string text;
  std::int64_t time = 0;    ///< of the measurement: UTC, ns
  double age_s = 0;         ///< age of the value when it was sent, by the monotonic clock
  std::string quality;      ///< "good", "stale" (older than three periods), "bad" (its source doubts it)
  std::uint64_t watch = 0;  ///< as in SensorWatch; 0: the answer to a SensorRead
  std::uint64_t count = 0;  ///< within the watch: 1, 2, 3 …; a gap shows what the lane lost
  bool operator==(const SensorReading&) const = default;
  template <class T = SensorReading>
  static FieldTable fields() {
    return FieldTable{field("sensor", &T::sensor, 64),   field("identity", &T::identity, 128),
                      field("unit", &T::unit, 16),       field("is_text", &T::is_text),
                      field("number", &T::number),       field("text", &T::text, 1024),
                      field("time", &T::time),           field("age_s", &T::age_s),
                      field("quality", &T::quality, 16), field("watch", &T::watch),
                      field("count", &T::count)};
  }
};

/// To a node's sensor-bus (request): one picture of a sensor of kind image. Answered by SensorImage on the lossy lane,
/// or a Nack: a requester that receives neither sends it again.
struct SensorSnapshot {
  static constexpr std::string_view kSubtype = "sensor_snapshot";
  static constexpr Travel kTravel = between_nodes(CostPhase::sensor);
  std::string sensor;
  std::string identity;  ///< takes precedence over `sensor`
  template <class T = SensorSnapshot>
  static FieldTable fields() {
    return FieldTable{field("sensor", &T::sensor, 64), field("identity", &T::identity, 128)};
  }
};

struct SensorImage {
  static constexpr std::string_view kSubtype = "sensor_image";
  static constexpr Travel kTravel = between_nodes(CostPhase::sensor);
  std::string sensor;
  std::string identity;
  std::string media_type;  ///< "image/jpeg"
  std::int64_t time = 0;   ///< UTC, ns
  Blob bytes;
  template <class T = SensorImage>
  static FieldTable fields() {
    return FieldTable{field("sensor", &T::sensor, 64), field("identity", &T::identity, 128),
                      field("media_type", &T::media_type, 32), field("time", &T::time),
                      field("bytes", &T::bytes, 1'000'000)};
  }
};

/// Requests a node's sensors from its sensor-bus, and the devices that match no rule.
struct SensorListRequest {
  static constexpr std::string_view kSubtype = "sensor_list";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  bool unknown = false;  ///< also the devices that match no rule
  template <class T = SensorListRequest>
  static FieldTable fields() {
    return FieldTable{field("unknown", &T::unknown)};
  }
};

/// A device that matches no rule, and a draft of a rule to edit.
struct UnknownDevice {
  std::string device;      ///< its path below /sys
  std::string properties;  ///< lines NAME=VALUE, for people
  std::string rule;        ///< JSON text
  template <class T = UnknownDevice>
  static FieldTable fields() {
    return FieldTable{field("device", &T::device, 512), field("properties", &T::properties, 4096),
                      field("rule", &T::rule, 2048)};
  }
};

struct SensorTable {
  static constexpr std::string_view kSubtype = "sensor_table";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string node;
  std::vector<SensorInfo> sensors;
  std::vector<UnknownDevice> unknown;
  std::string bus;  ///< the D-Bus: empty if it is available, else the problem
  template <class T = SensorTable>
  static FieldTable fields() {
    return FieldTable{field("node", &T::node, 64), field("sensors", &T::sensors, 255),
                      field("unknown", &T::unknown, 64), field("bus", &T::bus, 255)};
  }
};

}  // namespace trb
