// Bodies of scenarios and runs: between schedulers, and between a submitter or watcher and a scheduler.
#pragma once

#include "proto/bodies/choice.hpp"
#include "proto/bodies/decision.hpp"
#include "proto/bodies/robot.hpp"
#include "proto/bodies/signed.hpp"
#include "proto/field.hpp"

namespace trb {

constexpr std::uint32_t kMaxTasks = 1000;
constexpr std::uint32_t kMaxMembers = 1000;

/// A parameter whose value an earlier task's result gives.
struct ValueFrom {
  std::string parameter;
  std::string task;  ///< a direct predecessor
  std::string name;  ///< of the value in its result, a JSON object; empty: the whole result
  bool operator==(const ValueFrom&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("parameter", &ValueFrom::parameter, 64), field("task", &ValueFrom::task, 64),
                      field("name", &ValueFrom::name, 64)};
  }
};

/// What follows when a task has failed for good. `resilience`: the run waits, the fleet looks for another robot.
/// `skip`: it counts as SKIPPED. `abort`: the run is aborted.
enum class OnFailure : std::uint8_t { resilience = 0, skip, abort };
constexpr auto enum_names(OnFailure) {
  return std::array<std::string_view, 3>{"resilience", "skip", "abort"};
}

/// A node of the scenario's graph: a skill with data, given to a robot, or to whoever has the capabilities.
struct Task {
  std::string id;
  std::string robot;                   ///< empty if bound late by `requires`
  std::vector<std::string> requires_;  ///< capabilities
  std::string skill;
  std::string data;                  ///< the skill's parameters, a JSON object as text, or empty
  std::vector<std::uint16_t> after;  ///< indexes of the predecessors in Scenario::tasks
  double timeout_s = 0;              ///< 0: the skill's own
  bool pinned = false;  ///< cannot be re-assigned: may start while its node hears no majority (not while it is stopped)
  std::vector<Condition> when;  ///< none, or one: more are a later version's
  std::uint32_t retries = 0;    ///< how often the same robot tries again after the robot's own `failed`
  double retry_after_s = 1;     ///< before the first of them; doubled each time, 60 s at most
  OnFailure on_failure{};
  std::vector<ValueFrom> values{};
  bool operator==(const Task&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("id", &Task::id, 64),
                      field("robot", &Task::robot, 64),
                      field("requires", &Task::requires_, 32),
                      field("skill", &Task::skill, 64),
                      field("data", &Task::data, 65536),
                      field("after", &Task::after, kMaxTasks),
                      field("timeout_s", &Task::timeout_s),
                      field("pinned", &Task::pinned),
                      field("when", &Task::when, 8),
                      field("retries", &Task::retries),
                      field("retry_after_s", &Task::retry_after_s),
                      field("on_failure", &Task::on_failure),
                      field("values", &Task::values, 32)};
  }
};

struct Scenario {
  static constexpr std::string_view kSubtype = "scenario";
  std::string name;
  std::string description;
  std::vector<Task> tasks;
  bool operator==(const Scenario&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("name", &Scenario::name, 64), field("description", &Scenario::description, 4096),
                      field("tasks", &Scenario::tasks, kMaxTasks)};
  }
};

/// Which robot does which task, in the order of Scenario::tasks; part of an epoch.
struct Assignment {
  std::uint32_t epoch = 1;
  std::vector<std::string> robots;
  static constexpr auto fields() {
    return std::tuple{field("epoch", &Assignment::epoch), field("robots", &Assignment::robots, kMaxTasks)};
  }
};

/// The start of a run, signed by the submitter's node (purpose "run_start").
struct RunStart {
  static constexpr std::string_view kSubtype = "run_start";
  std::string run;  ///< 32 hexadecimal digits
  Blob digest;      ///< BLAKE2b-256 of the scenario's msgpack body
  Scenario scenario;
  Assignment first;
  std::vector<Member> members;          ///< the run's robots, the submitter's node and the cloud node
  std::vector<std::string> electorate;  ///< the run's robots, and the cloud node if their number is even
  std::string submitter;
  std::int64_t created = 0;  ///< UTC ns
  std::int64_t expires = 0;  ///< UTC ns
  static constexpr auto fields() {
    return std::tuple{field("run", &RunStart::run, 64),
                      field("digest", &RunStart::digest, 32),
                      field("scenario", &RunStart::scenario),
                      field("first", &RunStart::first),
                      field("members", &RunStart::members, kMaxMembers),
                      field("electorate", &RunStart::electorate, kMaxMembers),
                      field("submitter", &RunStart::submitter, 64),
                      field("created", &RunStart::created),
                      field("expires", &RunStart::expires)};
  }
};

/// What an actor says of an attempt, signed by its node (purpose "result").
struct TaskResult {
  static constexpr std::string_view kSubtype = "result";
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
  static constexpr auto fields() {
    return std::tuple{field("key", &TaskResult::key),          field("digest", &TaskResult::digest, 32),
                      field("epoch", &TaskResult::epoch),      field("robot", &TaskResult::robot, 64),
                      field("outcome", &TaskResult::outcome),  field("reason", &TaskResult::reason, 1024),
                      field("data", &TaskResult::data, 65536), field("started", &TaskResult::started),
                      field("ended", &TaskResult::ended),      field("duration_s", &TaskResult::duration_s)};
  }
};

/// The order to end a run, signed (purpose "run_abort"). Absorbing.
struct AbortOrder {
  static constexpr std::string_view kSubtype = "abort_order";
  std::string run;
  std::string by;
  std::string reason;
  std::int64_t time = 0;
  static constexpr auto fields() {
    return std::tuple{field("run", &AbortOrder::run, 64), field("by", &AbortOrder::by, 64),
                      field("reason", &AbortOrder::reason, 255), field("time", &AbortOrder::time)};
  }
};

/// `trb scenario run` -> the scheduler of its own node. Answered, once journaled, by RunAccepted or a Nack.
struct RunSubmit {
  static constexpr std::string_view kSubtype = "run_submit";
  SignedRecord start;
  static constexpr auto fields() { return std::tuple{field("start", &RunSubmit::start)}; }
};

struct RunAccepted {
  static constexpr std::string_view kSubtype = "run_accepted";
  std::string run;
  static constexpr auto fields() { return std::tuple{field("run", &RunAccepted::run, 64)}; }
};

/// What passes from actor to actor (command); resent until BatonJournaled.
struct Baton {
  static constexpr std::string_view kSubtype = "baton";
  std::string run;
  Blob digest;
  std::uint32_t epoch = 1;
  Blob final_tasks;                   ///< bitmap, task i is bit i%8 of byte i/8
  std::vector<SignedRecord> results;  ///< of the direct predecessors
  std::vector<std::uint16_t> tasks;   ///< the receiver's tasks, to execute or to choose on, that this baton is for
  std::vector<SignedRecord> choices;  ///< on those tasks
  Blob skipped_tasks;                 ///< those of `final_tasks` that are known to be SKIPPED
  static constexpr auto fields() {
    return std::tuple{field("run", &Baton::run, 64),
                      field("digest", &Baton::digest, 32),
                      field("epoch", &Baton::epoch),
                      field("final_tasks", &Baton::final_tasks, 128),
                      field("results", &Baton::results, kMaxTasks),
                      field("tasks", &Baton::tasks, kMaxTasks),
                      field("choices", &Baton::choices, kMaxTasks),
                      field("skipped_tasks", &Baton::skipped_tasks, 128)};
  }
};

/// The receiver holds definition and results of that baton on disk.
struct BatonJournaled {
  static constexpr std::string_view kSubtype = "baton_journaled";
  std::string run;
  std::uint32_t epoch = 1;
  std::vector<std::uint16_t> tasks;  ///< those of the baton
  static constexpr auto fields() {
    return std::tuple{field("run", &BatonJournaled::run, 64), field("epoch", &BatonJournaled::epoch),
                      field("tasks", &BatonJournaled::tasks, kMaxTasks)};
  }
};

struct NeedDefinition {
  static constexpr std::string_view kSubtype = "need_definition";
  std::string run;
  Blob digest;
  static constexpr auto fields() {
    return std::tuple{field("run", &NeedDefinition::run, 64), field("digest", &NeedDefinition::digest, 32)};
  }
};

struct Definition {
  static constexpr std::string_view kSubtype = "definition";
  SignedRecord start;
  std::vector<SignedRecord> decisions{};  ///< every one that the giver holds, from epoch 2 on
  static constexpr auto fields() {
    return std::tuple{field("start", &Definition::start), field("decisions", &Definition::decisions, 64)};
  }
};

/// Asks for the results of tasks that the other side knows to be final.
struct NeedResults {
  static constexpr std::string_view kSubtype = "need_results";
  std::string run;
  std::vector<std::uint16_t> tasks;
  static constexpr auto fields() {
    return std::tuple{field("run", &NeedResults::run, 64), field("tasks", &NeedResults::tasks, kMaxTasks)};
  }
};

/// Signed results: the acknowledgement to the cloud, or the answer to NeedResults; resent until ResultsJournaled.
struct Results {
  static constexpr std::string_view kSubtype = "results";
  std::string run;
  std::vector<SignedRecord> results;
  std::vector<SignedRecord> choices;  ///< on the tasks of these results
  static constexpr auto fields() {
    return std::tuple{field("run", &Results::run, 64), field("results", &Results::results, kMaxTasks),
                      field("choices", &Results::choices, kMaxTasks)};
  }
};

struct ResultsJournaled {
  static constexpr std::string_view kSubtype = "results_journaled";
  std::vector<AttemptKey> keys;
  static constexpr auto fields() { return std::tuple{field("keys", &ResultsJournaled::keys, kMaxTasks)}; }
};

/// VDA 5050's action states, and SKIPPED.
enum class TaskState : std::uint8_t {
  waiting = 0,
  initializing,
  running,
  paused,
  retriable,
  finished,
  failed,
  skipped
};
constexpr auto enum_names(TaskState) {
  return std::array<std::string_view, 8>{"WAITING",   "INITIALIZING", "RUNNING", "PAUSED",
                                         "RETRIABLE", "FINISHED",     "FAILED",  "SKIPPED"};
}

/// Live progress for watchers (information, may be lost).
struct TaskProgress {
  static constexpr std::string_view kSubtype = "task_progress";
  AttemptKey key;
  std::string robot;  ///< the task's, or, WAITING, who chooses on it
  TaskState state{};
  std::string detail;  ///< of WAITING: what its condition waits for, in words
  static constexpr auto fields() {
    return std::tuple{field("key", &TaskProgress::key), field("robot", &TaskProgress::robot, 64),
                      field("state", &TaskProgress::state), field("detail", &TaskProgress::detail, 512)};
  }
};

/// Carries an AbortOrder to a member (command); resent until AbortConfirmed.
struct RunAbort {
  static constexpr std::string_view kSubtype = "run_abort";
  SignedRecord order;
  static constexpr auto fields() { return std::tuple{field("order", &RunAbort::order)}; }
};

/// The member has journaled the abort and runs nothing of the run any more.
struct AbortConfirmed {
  static constexpr std::string_view kSubtype = "abort_confirmed";
  std::string run;
  static constexpr auto fields() { return std::tuple{field("run", &AbortConfirmed::run, 64)}; }
};

enum class RunState : std::uint8_t { running = 0, paused, aborting, finished, aborted, expired };
constexpr auto enum_names(RunState) {
  return std::array<std::string_view, 6>{"RUNNING", "PAUSED", "ABORTING", "FINISHED", "ABORTED", "EXPIRED"};
}

struct TaskView {
  std::string id;
  std::string robot;
  std::string skill;
  TaskState state{};
  TaskOutcome outcome{};
  std::string reason;
  std::uint32_t attempt = 0;
  std::int64_t started = 0;
  std::int64_t ended = 0;
  double duration_s = 0;
  std::vector<std::uint16_t> after;
  std::string condition;   ///< in words, with the value that decided if that is known; empty: it has none
  std::string moved_from;  ///< the robot that had it before; empty: it was never moved
  static constexpr auto fields() {
    return std::tuple{field("id", &TaskView::id, 64),
                      field("robot", &TaskView::robot, 64),
                      field("skill", &TaskView::skill, 64),
                      field("state", &TaskView::state),
                      field("outcome", &TaskView::outcome),
                      field("reason", &TaskView::reason, 1024),
                      field("attempt", &TaskView::attempt),
                      field("started", &TaskView::started),
                      field("ended", &TaskView::ended),
                      field("duration_s", &TaskView::duration_s),
                      field("after", &TaskView::after, kMaxTasks),
                      field("condition", &TaskView::condition, 512),
                      field("moved_from", &TaskView::moved_from, 64)};
  }
};

/// A decision, without what proves it.
struct DecisionView {
  std::uint32_t epoch = 2;
  std::string by;
  std::string alert;
  std::string person;  ///< empty: the policy
  std::string reason;
  std::int64_t time = 0;
  std::vector<TaskRuling> tasks;
  static constexpr auto fields() {
    return std::tuple{field("epoch", &DecisionView::epoch),           field("by", &DecisionView::by, 64),
                      field("alert", &DecisionView::alert, 64),       field("person", &DecisionView::person, 64),
                      field("reason", &DecisionView::reason, 1024),   field("time", &DecisionView::time),
                      field("tasks", &DecisionView::tasks, kMaxTasks)};
  }
};

/// A run as one scheduler knows it; the cloud node's knows every acknowledged result.
struct RunView {
  static constexpr std::string_view kSubtype = "run_view";
  std::string run;
  std::string name;
  RunState state{};
  std::string waits_for;  ///< when PAUSED or ABORTING: what for, in words
  std::uint32_t epoch = 1;
  std::string submitter;
  std::int64_t created = 0;
  std::int64_t expires = 0;
  std::vector<TaskView> tasks;
  std::vector<DecisionView> decisions;
  std::uint32_t pause_number = 0;  ///< of the pause order that counts; 0: there was none
  std::string paused_by;           ///< empty: it is not held
  static constexpr auto fields() {
    return std::tuple{field("run", &RunView::run, 64),
                      field("name", &RunView::name, 64),
                      field("state", &RunView::state),
                      field("waits_for", &RunView::waits_for, 1024),
                      field("epoch", &RunView::epoch),
                      field("submitter", &RunView::submitter, 64),
                      field("created", &RunView::created),
                      field("expires", &RunView::expires),
                      field("tasks", &RunView::tasks, kMaxTasks),
                      field("decisions", &RunView::decisions, 64),
                      field("pause_number", &RunView::pause_number),
                      field("paused_by", &RunView::paused_by, 64)};
  }
};

struct RunQuery {
  static constexpr std::string_view kSubtype = "run_query";
  std::string run;  ///< the id, or a unique beginning of it, or "" for the newest
  static constexpr auto fields() { return std::tuple{field("run", &RunQuery::run, 64)}; }
};

struct RunListRequest {
  static constexpr std::string_view kSubtype = "run_list";
  static constexpr auto fields() { return std::tuple{}; }
};

struct RunSummary {
  std::string run;
  std::string name;
  RunState state{};
  std::string waits_for;
  std::int64_t created = 0;
  std::uint32_t tasks = 0;
  std::uint32_t tasks_final = 0;
  std::uint32_t epoch = 1;
  std::uint64_t version = 0;  ///< rises with every change that this scheduler has seen since its start
  static constexpr auto fields() {
    return std::tuple{field("run", &RunSummary::run, 64),
                      field("name", &RunSummary::name, 64),
                      field("state", &RunSummary::state),
                      field("waits_for", &RunSummary::waits_for, 1024),
                      field("created", &RunSummary::created),
                      field("tasks", &RunSummary::tasks),
                      field("tasks_final", &RunSummary::tasks_final),
                      field("epoch", &RunSummary::epoch),
                      field("version", &RunSummary::version)};
  }
};

/// Asks a scheduler to tell of its runs (request): answered by RunTable at once, then, for `lease_s`, by RunChanged
/// with the same `reply_to` at each change.
struct RunWatch {
  static constexpr std::string_view kSubtype = "run_watch";
  double lease_s = 10;
  static constexpr auto fields() { return std::tuple{field("lease_s", &RunWatch::lease_s)}; }
};

/// A run has changed since the last word of it (information, may be lost: the next RunTable has it).
struct RunChanged {
  static constexpr std::string_view kSubtype = "run_changed";
  RunSummary run;
  static constexpr auto fields() { return std::tuple{field("run", &RunChanged::run)}; }
};

struct RunTable {
  static constexpr std::string_view kSubtype = "run_table";
  std::vector<RunSummary> runs;
  static constexpr auto fields() { return std::tuple{field("runs", &RunTable::runs, 1000)}; }
};

}  // namespace trb
