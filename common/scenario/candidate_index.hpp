// Which robots of the fleet can do a scenario's tasks: for its check, for its preflight, and to bind tasks late.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/scenario/task_need.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

using Profiles = std::map<std::string, NodeProfile>;

/// What prevents a robot from doing a task, as a fault of the scenario's file.
struct Obstacle {
  std::string key;  ///< within the task: "skill", "data.place"
  std::string what;
  std::string hint;
};

/// Everything that prevents the robot from doing the task, except what it is doing now: capabilities, skill,
/// parameters, places.
std::vector<Obstacle> obstacles(const TaskNeed& need, const std::string& robot, const NodeProfile& profile);

/// Why the robot cannot be given any task now: "is OFFLINE", "is stopped until it is released", "is retired by ann: new
/// wheels"; or "".
std::string why_not_ready(const NodeProfile& profile);
/// The same, and whether what the task needs is out of use: "cannot use 'carry': the gripper is jammed".
std::string why_not_ready(const Task& task, const NodeProfile& profile);

/// Warnings for robots that the tasks name and that cannot begin now: they may become ready, but a person should know.
void warn_of_robots(const Scenario& scenario, const Profiles& profiles, const std::string& file, ConfigFaults& faults);

/// Why a robot is not chosen for a task.
struct Reason {
  std::string robot;
  std::string text;  ///< with the robot's name
};

/// The robots that can do a task, by id. The search ends at two that are ready: one to do it, and a spare.
struct Able {
  std::vector<std::string> ready;
  std::vector<Reason> waiting;  ///< would be able, but for example "'pioneer2' is OFFLINE"; kMaxTold at most
  std::vector<Reason> unable;   ///< have the skill, but for example "'drone' has no capability 'carry'"; kMaxTold at
                                ///< most

  static constexpr std::size_t kMaxTold = 4;
  /// The reasons, the closest candidates first, without those of `except`; "" if no other robot comes close.
  [[nodiscard]] std::string reasons(const std::string& except = {}) const;
};

/// The fleet's robots by what they can do. Keeps the profiles by reference and caches answers: tasks with the same
/// needs are searched for once.
class CandidateIndex {
 public:
  explicit CandidateIndex(const Profiles& profiles);

  const Able& able(const Task& task);
  /// All robots that are ready and able, by id.
  const std::vector<std::string>& everybody(const Task& task);
  /// All skills and capabilities that robots of the fleet have.
  [[nodiscard]] std::vector<std::string> skills() const;
  [[nodiscard]] std::vector<std::string> capabilities() const;

 private:
  using Robot = Profiles::value_type;

  [[nodiscard]] const std::vector<const Robot*>& robots_with(const std::string& skill) const;

  const Profiles& profiles_;
  std::map<std::string_view, std::vector<const Robot*>> by_skill_;
  std::map<std::string, Able> known_;
  std::map<std::string, std::vector<std::string>> everybody_;
};

/// At most this many of a run's tasks are bound when they are due: each takes a decision, and a run may have 64.
constexpr std::size_t kMaxBoundWhenDue = 32;

/// Which node each task is assigned to at the start: the robot that it names; else `decider`, the cloud node that will
/// choose a robot when the task is due. Without a decider, or once it has kMaxBoundWhenDue tasks: of the robots that
/// are ready and able the one with the fewest tasks of this run, then the first by id. The decider gets the tasks that
/// gain most by waiting: first those that no robot can do now, then those that several could do, late ones before early
/// ones. A task that nobody can be found for is a fault.
std::vector<std::string> bind_tasks(const Scenario& scenario, CandidateIndex& candidates, const std::string& decider,
                                    const std::string& file, ConfigFaults& faults);

/// A task that no other robot could take over now.
struct NoSpare {
  std::string task;
  std::string robot;  ///< who does it; empty: bound late, and none can do it now, or several can
  std::string why;
};

/// The tasks without a spare, in the file's order; of a repeated scenario, those of the first round.
std::vector<NoSpare> tasks_without_spare(const Scenario& scenario, CandidateIndex& candidates);

}  // namespace trb
