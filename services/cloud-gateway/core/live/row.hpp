// One item of the fleet as clients see it, and its encoded bytes.
#pragma once

#include <compare>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/time.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/resilience.hpp"
#include "proto/bodies/robot.hpp"
#include "proto/bodies/run_view.hpp"
#include "proto/bodies/sensor.hpp"
#include "services/cloud-gateway/core/alarms/alarm.hpp"

namespace trb::gateway {

enum class RowKind : std::uint8_t { node = 0, robot, profile, run, run_detail, alert, sensor, reading, teleop };
constexpr auto enum_names(RowKind) {
  return std::array<std::string_view, 9>{"node",  "robot",  "profile", "run",   "run_detail",
                                         "alert", "sensor", "reading", "teleop"};
}

/// README.md says when each value applies.
enum class Live : std::uint8_t { live = 0, late, not_heard, refused };
constexpr auto enum_names(Live) {
  return std::array<std::string_view, 4>{"live", "late", "not_heard", "refused"};
}

/// A service of the gateway's own node whose tables become rows.
enum class RowSource : std::uint8_t { router = 0, scheduler, resilience };
constexpr auto enum_names(RowSource) {
  return std::array<std::string_view, 3>{"router", "scheduler", "resilience"};
}
using RowSources = std::vector<RowSource>;

struct RowKey {
  RowKind kind{};
  std::string node;  ///< the owner; empty: from services of the gateway's own node
  std::string name;  ///< of a run, alert or sensor
  auto operator<=>(const RowKey&) const = default;
};

/// Route without profile; of its certificate the end.
struct NodeRow {
  Role role{};
  std::string state;  ///< as Route::state
  std::string address;
  std::string version;
  std::string clock;
  std::string via;
  std::string reason;  ///< why it has expired
  std::uint64_t boot = 0;
  UtcTime certificate_ends{};  ///< 0: not known yet
  bool operator==(const NodeRow&) const = default;
};

struct RobotValue {
  std::string name;
  std::string value;  ///< JSON text, as the robot sent it
  UtcTime changed;
  bool operator==(const RobotValue&) const = default;
};

struct RobotRowFault {
  std::string capability;  ///< empty: the whole robot
  Severity severity{};
  std::string text;
  UtcTime since;
  bool operator==(const RobotRowFault&) const = default;
};

struct RobotRow {
  std::string connection;  ///< as NodeProfile::robot; empty: not received yet
  std::string detail;
  bool fenced = false;
  std::string control;
  std::vector<OutOfUse> out_of_use;
  std::vector<RobotValue> values;     ///< by name
  std::vector<RobotRowFault> faults;  ///< by capability and severity; one of each
  bool cut = false;                   ///< the robot sent more values or faults than are kept
  std::vector<DriveInfo> drives{};    ///< what of it a person can drive by hand
  bool operator==(const RobotRow&) const = default;
};

/// Who drives a robot by hand through this gateway; no row: nobody.
struct TeleopRow {
  std::string holder;       ///< the driving user; empty: the drive is over, and the next one is kept for `kept_for`
  std::string asked_by;     ///< who asks for the robot; empty: nobody
  std::string kept_for;     ///< who alone may begin now
  double round_trip_s = 0;  ///< gateway - robot's node - gateway; 0: not known yet
  bool operator==(const TeleopRow&) const = default;
};

struct AlertRow {
  Alert alert;
  Alarm alarm;
  bool operator==(const AlertRow&) const = default;
};

/// std::monostate: the row was removed.
using RowContent = std::variant<std::monostate, NodeRow, RobotRow, NodeProfile, RunSummary, RunView, AlertRow,
                                SensorInfo, SensorReading, TeleopRow>;

/// True if a client sees no difference; a countdown (left_s) does not count as one.
bool same_content(const RowContent& a, const RowContent& b);
/// Approximate size in bytes, in memory and as JSON; never 0.
std::size_t size_of(const RowContent& content);

/// Shared by all clients that they are sent to.
using SharedBytes = std::shared_ptr<const Bytes>;

/// A row as it was last read, and in which state it was: what it says changes with one of the three alone.
struct ReadRow {
  SharedBytes bytes;
  std::uint64_t number = 0;
  std::uint64_t version = 0;
  Live live{};
};

struct Row {
  RowKey key;
  RowContent content;
  std::uint64_t number = 0;   ///< the book's count when the row was last published
  std::uint64_t version = 0;  ///< of the content
  Now heard;                  ///< when this content was last received
  Now published;              ///< `heard` when the row was last published
  Live live{};
  bool is_refused = false;    ///< a newer content was refused: its node is over budget
  std::size_t size = 0;       ///< size_of(content)
  mutable SharedBytes bytes;  ///< the published row, encoded on demand by BlockMaker
  mutable ReadRow read;       ///< encoded on demand by json_of
  [[nodiscard]] bool is_removed() const { return std::holds_alternative<std::monostate>(content); }
};

/// Implemented by the shell: encodes a row once for all clients.
class RowEncoder {
 public:
  RowEncoder() = default;
  RowEncoder(const RowEncoder&) = delete;
  RowEncoder& operator=(const RowEncoder&) = delete;
  virtual ~RowEncoder() = default;
  [[nodiscard]] virtual Bytes encode(const Row& row) = 0;
};

}  // namespace trb::gateway
