// What this node knows about the fleet and its own scheduler's runs. Messages change it; it returns which runs and
// alerts have to be looked at.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "common/actor/core.hpp"
#include "common/actor/outbox.hpp"
#include "services/resilience/core/core_settings.hpp"
#include "services/resilience/core/due_runs.hpp"
#include "services/resilience/core/liveness.hpp"
#include "services/resilience/core/open_tasks.hpp"
#include "services/resilience/core/route_requests.hpp"
#include "services/resilience/core/run_watcher.hpp"

namespace trb::resilience {

class Situation {
 public:
  explicit Situation(CoreSettings settings) : settings_(std::move(settings)) {}

  [[nodiscard]] const std::string& node() const { return settings_.node; }
  [[nodiscard]] const CoreSettings& settings() const { return settings_; }
  [[nodiscard]] const Fleet& fleet() const { return fleet_; }
  Fleet& fleet() { return fleet_; }
  [[nodiscard]] const RunWatcher& runs() const { return runs_; }
  RunWatcher& runs() { return runs_; }
  [[nodiscard]] const Liveness& liveness() const { return liveness_; }
  RouteRequests& routes() { return routes_; }
  [[nodiscard]] const RouteRequests& routes() const { return routes_; }
  DueRuns& due_runs() { return due_runs_; }
  [[nodiscard]] const DueRuns& due_runs() const { return due_runs_; }
  /// The robot's certificate, from the router's table; nullptr: not known.
  [[nodiscard]] const SignedRecord* certificate_of(std::string_view robot) const;
  /// Does the router's last table not have the robot? Its router may also have started anew a moment ago.
  [[nodiscard]] bool is_missing(std::string_view robot) const;
  /// The robot has left the fleet for good.
  void forget(const std::string& robot, Now now);
  /// Has the router's first table come? Before that no robot counts as reached, and nothing is judged.
  [[nodiscard]] bool is_judged() const { return judged_; }
  /// Does this node decide on the run: is it the first cloud node among its members?
  [[nodiscard]] bool decides_on(const WatchedRun* run) const;

  void on_welcome(const NodeIdentity& node, Now now);
  /// What the robots' nodes and the own router send. `robot` is the sender.
  void receive(const RobotState& state, const std::string& robot, Now now, Outbox& out);
  void receive(const RobotFault& fault, const std::string& robot, Now now, Outbox& out);
  void receive(const RobotConnection& connection, const std::string& robot, Now now, Outbox& out);
  void receive(const PeerJoined& peer, Now now, Outbox& out);
  void receive(const PeerExpired& peer, Now now);
  void receive(const RouteTable& table, Now now, Outbox& out);

  /// Something about the robot has changed: its runs are due. `expired`: the router has just reported that its lease
  /// has run out.
  void note_robot(const std::string& robot, Now now, bool expired = false);
  /// The runs that have changed, or are due, by id.
  std::set<std::string> take_due_runs(Now now);

  /// Something has changed that alerts may depend on.
  void note_change() { changed_ = true; }
  bool take_change() { return std::exchange(changed_, false); }
  [[nodiscard]] bool has_change() const { return changed_; }

 private:
  void judge_all(Now now);
  void expire_unlisted(Now now);
  void count_tasks(const std::string& run);

  CoreSettings settings_;
  Fleet fleet_;
  RunWatcher runs_;
  Liveness liveness_;
  RouteRequests routes_;
  DueRuns due_runs_;
  OpenTasks open_tasks_;
  std::map<std::string, SignedRecord, std::less<>> certificates_;
  std::set<std::string, std::less<>> listed_;      ///< the robots of the router's last table
  std::map<std::string, MonotonicTime> unlisted_;  ///< reached ones that it lacks, and since when
  bool changed_ = true;
  bool judged_ = false;
};

}  // namespace trb::resilience
