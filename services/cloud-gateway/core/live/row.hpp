// What one thing of the fleet looks like to a client, and where io keeps its bytes.
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
#include "proto/bodies/run.hpp"
#include "proto/bodies/sensor.hpp"

namespace trb::gateway {

enum class RowKind : std::uint8_t { node = 0, robot, profile, run, run_detail, alert, sensor, reading, teleop };
constexpr auto enum_names(RowKind) {
  return std::array<std::string_view, 9>{"node",  "robot",  "profile", "run",   "run_detail",
                                         "alert", "sensor", "reading", "teleop"};
}

/// README.md says when a row is what.
enum class Live : std::uint8_t { live = 0, late, not_heard, refused };
constexpr auto enum_names(Live) {
  return std::array<std::string_view, 4>{"live", "late", "not_heard", "refused"};
}

struct RowKey {
  RowKind kind{};
  std::string node;  ///< whose it is; empty: the own node's services tell it
  std::string name;  ///< of a run, an alert, a sensor
  auto operator<=>(const RowKey&) const = default;
};

/// Route without certificate and profile.
struct NodeRow {
  Role role{};
  std::string state;  ///< as Route::state
  std::string address;
  std::string version;
  std::string clock;
  std::string via;
  std::string reason;  ///< why it has expired
  std::uint64_t boot = 0;
  bool operator==(const NodeRow&) const = default;
};

struct RobotValue {
  std::string name;
  std::string value;  ///< JSON text, as the robot told it
  UtcTime changed;
  bool operator==(const RobotValue&) const = default;
};

struct RobotRowFault {
  std::string capability;  ///< empty: of the whole robot
  Severity severity{};
  std::string text;
  UtcTime since;
  bool operator==(const RobotRowFault&) const = default;
};

struct RobotRow {
  std::string connection;  ///< as NodeProfile::robot; empty: it has not said it yet
  std::string detail;
  bool fenced = false;
  std::string control;
  std::vector<OutOfUse> out_of_use;
  std::vector<RobotValue> values;     ///< by name
  std::vector<RobotRowFault> faults;  ///< by capability and severity; one of each
  bool cut = false;                   ///< it has said more values or faults than are kept
  bool operator==(const RobotRow&) const = default;
};

struct TeleopRow {
  std::string holder;  ///< the user who drives; empty: nobody
  double latency_s = 0;
  double speed_limit = 0;  ///< of the robot's full speed, 0 to 1
  bool operator==(const TeleopRow&) const = default;
};

/// std::monostate: it is not there any more.
using RowContent = std::variant<std::monostate, NodeRow, RobotRow, NodeProfile, RunSummary, RunView, Alert, SensorInfo,
                                SensorReading, TeleopRow>;

/// True if a client sees no difference; what runs down by itself (left_s) is none.
bool same_content(const RowContent& a, const RowContent& b);
/// About as many bytes as it takes, in memory and as JSON; never 0.
std::size_t size_of(const RowContent& content);

/// Shared by every client that is sent them.
using SharedBytes = std::shared_ptr<const Bytes>;

struct Row {
  RowKey key;
  RowContent content;
  std::uint64_t number = 0;   ///< when it was told last, by the book's count
  std::uint64_t version = 0;  ///< of the content
  Now heard;                  ///< when somebody said this content last
  Now told;                   ///< what `heard` was when it was told
  Live live{};
  bool is_refused = false;    ///< its node has said something newer that was over the budget
  std::size_t size = 0;       ///< size_of(content)
  mutable SharedBytes bytes;  ///< of what was told, once somebody wants it: BlockMaker
  [[nodiscard]] bool is_removed() const { return std::holds_alternative<std::monostate>(content); }
};

/// Of io: it makes the bytes of a row once, for all clients.
class RowEncoder {
 public:
  RowEncoder() = default;
  RowEncoder(const RowEncoder&) = delete;
  RowEncoder& operator=(const RowEncoder&) = delete;
  virtual ~RowEncoder() = default;
  [[nodiscard]] virtual Bytes encode(const Row& row) = 0;
};

}  // namespace trb::gateway
