// A scenario, and what is signed of a run: its start, results, orders, end.
#pragma once

#include "proto/bodies/choice.hpp"
#include "proto/bodies/decision.hpp"
#include "proto/bodies/robot.hpp"
#include "proto/bodies/signed.hpp"
#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

constexpr std::uint32_t kMaxTasks = 1000;
constexpr std::uint32_t kMaxMembers = 1000;
constexpr std::uint32_t kMaxPriority = 9;

/// A parameter whose value comes from an earlier task's result.
struct ValueFrom {
  std::string parameter;
  std::string task;  ///< a direct predecessor
  std::string name;  ///< of the value in its result, a JSON object; empty: the whole result
  bool operator==(const ValueFrom&) const = default;
  template <class T = ValueFrom>
  static FieldTable fields() {
    return FieldTable{field("parameter", &T::parameter, 64), field("task", &T::task, 64), field("name", &T::name, 64)};
  }
};

/// What follows when a task has failed for good. `resilience`: the run waits, the fleet looks for another robot.
/// `skip`: it counts as SKIPPED, and so do tasks that follow nothing else. `abort`: the run is aborted. `continue`: it
/// counts as SKIPPED, and the tasks that follow it go on.
enum class OnFailure : std::uint8_t { resilience = 0, skip, abort, continue_ };
constexpr auto enum_names(OnFailure) {
  return std::array<std::string_view, 4>{"resilience", "skip", "abort", "continue"};
}

/// A node of the scenario's graph: a skill with data, assigned to a robot, or to any robot with the capabilities.
struct Task {
  std::string id;
  std::string robot;                   ///< empty if the robot is chosen later, by `requires`
  std::vector<std::string> requires_;  ///< capabilities
  std::string skill;
  std::string data;                  ///< the skill's parameters, a JSON object as text, or empty
  std::vector<std::uint16_t> after;  ///< indexes of the predecessors in Scenario::tasks
  double timeout_s = 0;              ///< 0: the skill's default
  bool pinned = false;               ///< no decision moves it, except the one that first gives it a robot
  std::vector<Condition> when;       ///< none or one; more are reserved for a later version
  std::uint32_t retries = 0;         ///< how often the same robot tries again after it reported `failed`
  double retry_after_s = 1;          ///< before the first retry; doubled each time, up to 60 s
  OnFailure on_failure{};
  std::vector<ValueFrom> values{};
  double start_within_s = 0;  ///< after it is due; if it has not begun by then, it has failed. 0: it waits
  bool operator==(const Task&) const = default;
  template <class T = Task>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64),
                      field("robot", &T::robot, 64),
                      field("requires", &T::requires_, 32),
                      field("skill", &T::skill, 64),
                      field("data", &T::data, 65536),
                      field("after", &T::after, kMaxTasks),
                      field("timeout_s", &T::timeout_s),
                      field("pinned", &T::pinned),
                      field("when", &T::when, 8),
                      field("retries", &T::retries),
                      field("retry_after_s", &T::retry_after_s),
                      field("on_failure", &T::on_failure),
                      field("values", &T::values, 32),
                      field("start_within_s", &T::start_within_s)};
  }
};

struct Scenario {
  static constexpr std::string_view kSubtype = "scenario";
  static constexpr Travel kTravel = in_record();
  std::string name;
  std::string description;
  std::vector<Task> tasks;
  bool operator==(const Scenario&) const = default;
  template <class T = Scenario>
  static FieldTable fields() {
    return FieldTable{field("name", &T::name, 64), field("description", &T::description, 4096),
                      field("tasks", &T::tasks, kMaxTasks)};
  }
};

/// Which robot does which task, in the order of Scenario::tasks; part of an epoch.
struct Assignment {
  std::uint32_t epoch = 1;
  std::vector<std::string> robots;
  template <class T = Assignment>
  static FieldTable fields() {
    return FieldTable{field("epoch", &T::epoch), field("robots", &T::robots, kMaxTasks)};
  }
};

/// The start of a run, signed by the submitter's node (purpose "run_start").
struct RunStart {
  static constexpr std::string_view kSubtype = "run_start";
  static constexpr Travel kTravel = in_record();
  std::string run;  ///< 32 hexadecimal digits
  Blob digest;      ///< BLAKE2b-256 of the scenario's msgpack body
  Scenario scenario;
  Assignment first;
  std::vector<Member> members;          ///< the run's robots, the submitter's node and the cloud node
  std::vector<std::string> electorate;  ///< the run's robots, and the cloud node if their number is even
  std::string submitter;
  std::int64_t created = 0;    ///< UTC ns
  std::int64_t expires = 0;    ///< UTC ns
  std::uint32_t priority = 0;  ///< 0 to kMaxPriority: of two runs that want the same robot, the higher one begins
  template <class T = RunStart>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64),
                      field("digest", &T::digest, 32),
                      field("scenario", &T::scenario),
                      field("first", &T::first),
                      field("members", &T::members, kMaxMembers),
                      field("electorate", &T::electorate, kMaxMembers),
                      field("submitter", &T::submitter, 64),
                      field("created", &T::created),
                      field("expires", &T::expires),
                      field("priority", &T::priority)};
  }
};

/// What an actor reports about an attempt, signed by its node (purpose "result").
struct TaskResult {
  static constexpr std::string_view kSubtype = "result";
  static constexpr Travel kTravel = in_record();
  AttemptKey key;
  Blob digest;
  std::uint32_t epoch = 1;
  std::string robot;
  TaskOutcome outcome{};
  std::string reason;
  std::string data;
  std::int64_t started = 0;  ///< UTC ns
  std::int64_t ended = 0;    ///< UTC ns
  double duration_s = 0;     ///< by the robot's monotonic clock
  bool goes_on = false;      ///< SKIPPED, and what follows goes on nevertheless
  template <class T = TaskResult>
  static FieldTable fields() {
    return FieldTable{field("key", &T::key),          field("digest", &T::digest, 32),
                      field("epoch", &T::epoch),      field("robot", &T::robot, 64),
                      field("outcome", &T::outcome),  field("reason", &T::reason, 1024),
                      field("data", &T::data, 65536), field("started", &T::started),
                      field("ended", &T::ended),      field("duration_s", &T::duration_s),
                      field("goes_on", &T::goes_on)};
  }
};

/// The order to end a run, signed (purpose "run_abort"). Final: no later order changes it.
struct AbortOrder {
  static constexpr std::string_view kSubtype = "abort_order";
  static constexpr Travel kTravel = in_record();
  std::string run;
  std::string by;
  std::string reason;
  std::int64_t time = 0;
  template <class T = AbortOrder>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("by", &T::by, 64), field("reason", &T::reason, 255),
                      field("time", &T::time)};
  }
};

enum class RunState : std::uint8_t { running = 0, paused, aborting, finished, aborted, expired };
constexpr auto enum_names(RunState) {
  return std::array<std::string_view, 6>{"RUNNING", "PAUSED", "ABORTING", "FINISHED", "ABORTED", "EXPIRED"};
}

/// States that a run has FINISHED, signed (purpose "run_end") by the node that has every result: the run's decider, or,
/// without one, its submitter's node. From then on no node owes anything for it.
struct RunEnd {
  static constexpr std::string_view kSubtype = "run_end";
  static constexpr Travel kTravel = in_record();
  std::string run;
  Blob digest;
  std::string by;
  RunState state{};       ///< FINISHED
  std::int64_t time = 0;  ///< UTC ns
  template <class T = RunEnd>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("digest", &T::digest, 32), field("by", &T::by, 64),
                      field("state", &T::state), field("time", &T::time)};
  }
};

}  // namespace trb
