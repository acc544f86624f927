// The capability database in memory: every robot's record, the index for queries, and what is not on disk yet.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/write_share.hpp"
#include "services/resilience/core/fleet_index.hpp"
#include "services/resilience/core/robot_record.hpp"

namespace trb::resilience {

/// A line of the history, for people. `kind`: joined, expired, connection, fenced, released, profile, fault,
/// fault_ended, retired, returned, forgotten.
struct HistoryEntry {
  UtcTime time;
  std::string robot;
  std::string kind;
  std::string text;
  bool operator==(const HistoryEntry&) const = default;
};

/// What has changed since it was last written.
struct Changes {
  /// kNode: connection, fence, control, availability.
  enum Part : unsigned { kNode = 1, kAbilities = 2, kState = 4, kFaults = 8, kGone = 16 };
  std::map<std::string, unsigned, std::less<>> robots;  ///< id -> parts
  std::deque<HistoryEntry> history;                     ///< oldest first
  std::size_t history_dropped = 0;                      ///< lines lost because the disk failed for too long
  bool at_once = false;                                 ///< some robot's change is within its share

  [[nodiscard]] bool empty() const { return robots.empty() && history.empty(); }
  /// Are there changes besides values and control, which are sent again anyway, and of robots that have not used up
  /// their share? They must be on disk before anything based on them is sent.
  [[nodiscard]] bool urgent() const { return at_once || !history.empty(); }
};

class Fleet {
 public:
  static constexpr std::size_t kMaxRobots = 10'000;
  static constexpr std::size_t kMaxPendingHistory = 1000;

  Fleet() = default;
  Fleet(Fleet&&) = default;  ///< a copy's pointers would lead into the original
  Fleet& operator=(Fleet&&) = default;

  /// As it was on disk; no robot is reached before the router reports it. Errors: too_large, bad_value (no id),
  /// duplicate.
  Status restore(RobotRecord robot);

  /// A row of the router's table (Route::state "self" and "ONLINE": reached). True: something about the robot has
  /// changed. Errors: too_large (kMaxRobots), bad_value (no id); the node is then not known here.
  Result<bool> on_route(const Route& route, UtcTime now);
  Status on_joined(std::string_view id, UtcTime now);
  void on_expired(std::string_view id, const std::string& reason, UtcTime now);

  /// Sent by the robot's node. False: the robot is not known, or a bound is exceeded; nothing has changed.
  bool on_connection(std::string_view id, const RobotConnection& connection, UtcTime now);
  bool on_state(std::string_view id, const RobotState& state, UtcTime now);
  /// One value: the answer to a request of that subtype.
  bool on_value(std::string_view id, const std::string& name, const std::string& value, UtcTime now);
  /// Also adds a robot that is not known yet: a fault is sent once, and may come before its node's profile. An ended
  /// fault is over, unless it was found by something other than the robot.
  bool on_fault(std::string_view id, const RobotFault& fault, UtcTime now);

  /// Ends the faults of that capability (empty: of the whole robot, and no others), by an operator's command or by
  /// inference; `why` is kept in the history. False: there was none.
  bool end_faults(std::string_view id, std::string_view capability, const std::string& why, UtcTime now);
  bool set_later_tasks(std::string_view id, std::uint32_t tasks);
  /// The robot has left the fleet for good.
  void forget(std::string_view id, UtcTime now);

  [[nodiscard]] const RobotRecord* find(std::string_view id) const;
  /// `number`: one that the index has returned.
  [[nodiscard]] const RobotRecord& record(RobotNumber number) const { return *by_number_[number]; }
  /// By id.
  [[nodiscard]] const std::map<std::string, RobotRecord, std::less<>>& robots() const { return robots_; }
  [[nodiscard]] const FleetIndex& index() const { return index_; }

  /// Is any robot out of service?
  [[nodiscard]] bool has_retired() const { return !retired_.empty(); }
  /// Increases with every change of a robot's faults.
  [[nodiscard]] std::uint64_t fault_changes() const { return fault_changes_; }
  [[nodiscard]] const Changes& changes() const { return changes_; }
  /// The changes are on disk.
  void written() { changes_ = {}; }

 private:
  /// However much a robot tells, what people have done with it is kept.
  struct Shares {
    WriteShare of_robot;
    WriteShare of_people;
  };
  Result<RobotRecord*> insert(std::string_view id);
  Result<RobotRecord*> known(std::string_view id, UtcTime now);
  RobotRecord* existing(std::string_view id);
  void changed(const RobotRecord& robot, unsigned parts, UtcTime now);
  void note(const RobotRecord& robot, std::string_view kind, std::string_view text, UtcTime now);
  void note(const RobotRecord& robot, std::string_view kind, std::string_view text, WriteShare& share, UtcTime now);
  void drop_pending(const std::string& asking);
  static bool take_certificate(RobotRecord& robot, const SignedRecord& told);
  bool take_profile(RobotRecord& robot, const NodeProfile& told, UtcTime now);
  bool on_fault_ended(std::string_view id, const RobotFault& told, UtcTime now);
  bool take_out_of_use(RobotRecord& robot, const NodeProfile& before, const NodeProfile& profile, UtcTime now);
  void note_service(const RobotRecord& robot, const NodeProfile& before, const NodeProfile& profile, UtcTime now);
  bool set_reached(RobotRecord& robot, bool reached, const std::string& reason, UtcTime now);

  std::map<std::string, RobotRecord, std::less<>> robots_;
  FleetIndex index_;
  std::vector<const RobotRecord*> by_number_;
  Changes changes_;
  std::map<std::string, Shares, std::less<>> shares_;  ///< by robot, once something of it was written
  std::uint64_t fault_changes_ = 0;
  std::set<std::string, std::less<>> retired_;
};

}  // namespace trb::resilience
