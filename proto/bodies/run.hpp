// Bodies of scenarios and runs: between schedulers, and between a submitter or watcher and a scheduler.
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
/// Orders that count for a run: one to hold it or let it continue, one to abort it.
constexpr std::uint32_t kMaxOrders = 2;
constexpr std::uint32_t kMaxShortForm = 1U << 19U;
/// Start, end, 64 decisions, the orders, and a choice and a result for each task are fewer.
constexpr std::uint32_t kMaxRunRecords = 4000;

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
  bool pinned = false;  ///< cannot be re-assigned: may start without a majority (but not while the node is stopped)
  std::vector<Condition> when;  ///< none or one; more are reserved for a later version
  std::uint32_t retries = 0;    ///< how often the same robot tries again after it reported `failed`
  double retry_after_s = 1;     ///< before the first retry; doubled each time, 60 s at most
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

/// Carries a RunEnd to a member (information): sent once, and again to every node that requests it.
struct RunOver {
  static constexpr std::string_view kSubtype = "run_over";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep, {"scheduler"});
  SignedRecord end;
  template <class T = RunOver>
  static FieldTable fields() {
    return FieldTable{field("end", &T::end)};
  }
};

/// A member with nothing left to do in a run requests its end from the node that signs it. Answered by RunOver, or Ack
/// "not_over".
struct NeedEnd {
  static constexpr std::string_view kSubtype = "need_end";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep, {"scheduler"});
  std::string run;
  template <class T = NeedEnd>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64)};
  }
};

/// `trb scenario run` -> the scheduler of its own node. Answered, once journaled, by RunAccepted or a Nack.
struct RunSubmit {
  static constexpr std::string_view kSubtype = "run_submit";
  static constexpr Travel kTravel = on_bus(CostPhase::boot, {kProbe, "cloud-gateway"});
  SignedRecord start;
  template <class T = RunSubmit>
  static FieldTable fields() {
    return FieldTable{field("start", &T::start)};
  }
};

struct RunAccepted {
  static constexpr std::string_view kSubtype = "run_accepted";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string run;
  template <class T = RunAccepted>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64)};
  }
};

/// What passes from actor to actor (command); resent until BatonJournaled.
struct Baton {
  static constexpr std::string_view kSubtype = "baton";
  static constexpr Travel kTravel = between_nodes(CostPhase::forward);
  std::string run;
  Blob digest;
  std::uint32_t epoch = 1;
  Blob final_tasks;                    ///< bitmap, task i is bit i%8 of byte i/8
  std::vector<SignedRecord> results;   ///< of the direct predecessors
  std::vector<std::uint16_t> tasks;    ///< the receiver's tasks that this baton is for, to execute or to choose on
  std::vector<SignedRecord> choices;   ///< for those tasks
  Blob skipped_tasks;                  ///< those of `final_tasks` that are known to be SKIPPED
  std::vector<SignedRecord> orders{};  ///< that the giver knows: they apply before any of the tasks begins
  /// Run, digest, epoch, what is final, and results, as services/scheduler/core/run/short_form.hpp writes them for who
  /// has the run's definition; those fields are empty then, but for results that have no short form. Else empty.
  Blob short_form{};
  template <class T = Baton>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64),
                      field("digest", &T::digest, 32),
                      field("epoch", &T::epoch),
                      field("final_tasks", &T::final_tasks, 128),
                      field("results", &T::results, kMaxTasks),
                      field("tasks", &T::tasks, kMaxTasks),
                      field("choices", &T::choices, kMaxTasks),
                      field("skipped_tasks", &T::skipped_tasks, 128),
                      field("orders", &T::orders, kMaxOrders),
                      field("short_form", &T::short_form, kMaxShortForm)};
  }
};

/// The receiver has the definition and the results of that baton on disk.
struct BatonJournaled {
  static constexpr std::string_view kSubtype = "baton_journaled";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string run;
  std::uint32_t epoch = 1;
  std::vector<std::uint16_t> tasks;  ///< the tasks of the baton
  bool reads_short = false;          ///< the sender understands short forms
  template <class T = BatonJournaled>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("epoch", &T::epoch), field("tasks", &T::tasks, kMaxTasks),
                      field("reads_short", &T::reads_short)};
  }
};

struct NeedDefinition {
  static constexpr std::string_view kSubtype = "need_definition";
  static constexpr Travel kTravel = between_nodes(CostPhase::forward);
  std::string run;
  Blob digest;
  bool compact = false;      ///< the requester knows the members' certificates
  bool reads_short = false;  ///< the requester understands short forms, and a compact definition that counts on
  template <class T = NeedDefinition>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("digest", &T::digest, 32), field("compact", &T::compact),
                      field("reads_short", &T::reads_short)};
  }
};

struct Definition {
  static constexpr std::string_view kSubtype = "definition";
  static constexpr Travel kTravel = between_nodes(CostPhase::forward);
  SignedRecord start;                     ///< its payload is empty if `compact` has it
  std::vector<SignedRecord> decisions{};  ///< every decision that the giver has, from epoch 2 on
  std::vector<SignedRecord> orders{};     ///< that the giver knows, as in Baton
  /// The start's payload without the members' certificates, in zlib's form; empty: not asked for, or not to be had.
  Blob compact{};
  /// In `compact` a task that has no id bears the id before it, counted on by one, and `after` says how many tasks
  /// before it each one is.
  bool counts_on = false;
  template <class T = Definition>
  static FieldTable fields() {
    return FieldTable{field("start", &T::start), field("decisions", &T::decisions, 64),
                      field("orders", &T::orders, kMaxOrders), field("compact", &T::compact, 1U << 19U),
                      field("counts_on", &T::counts_on)};
  }
};

/// Requests the results of tasks that the other node knows to be final.
struct NeedResults {
  static constexpr std::string_view kSubtype = "need_results";
  static constexpr Travel kTravel = between_nodes(CostPhase::forward);
  std::string run;
  std::vector<std::uint16_t> tasks;
  template <class T = NeedResults>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("tasks", &T::tasks, kMaxTasks)};
  }
};

/// Signed results: the acknowledgement to the cloud, or the answer to NeedResults; resent until ResultsJournaled.
struct Results {
  static constexpr std::string_view kSubtype = "results";
  static constexpr Travel kTravel = between_nodes(CostPhase::task);
  std::string run;
  std::vector<SignedRecord> results;
  std::vector<SignedRecord> choices;  ///< for the tasks of these results
  Blob short_form{};                  ///< run and results, as in Baton
  template <class T = Results>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("results", &T::results, kMaxTasks),
                      field("choices", &T::choices, kMaxTasks), field("short_form", &T::short_form, kMaxShortForm)};
  }
};

struct ResultsJournaled {
  static constexpr std::string_view kSubtype = "results_journaled";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::vector<AttemptKey> keys;
  bool reads_short = false;  ///< the sender understands short forms
  template <class T = ResultsJournaled>
  static FieldTable fields() {
    return FieldTable{field("keys", &T::keys, kMaxTasks), field("reads_short", &T::reads_short)};
  }
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
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  AttemptKey key;
  std::string robot;  ///< the task's robot, or, if WAITING, the one that chooses on it
  TaskState state{};
  std::string detail;  ///< what it waits for, as text: its condition (WAITING), its robot (INITIALIZING)
  template <class T = TaskProgress>
  static FieldTable fields() {
    return FieldTable{field("key", &T::key), field("robot", &T::robot, 64), field("state", &T::state),
                      field("detail", &T::detail, 512)};
  }
};

/// Carries an AbortOrder to a member (command); resent until AbortConfirmed.
struct RunAbort {
  static constexpr std::string_view kSubtype = "run_abort";
  static constexpr Travel kTravel = between_nodes(CostPhase::fail);
  SignedRecord order;
  template <class T = RunAbort>
  static FieldTable fields() {
    return FieldTable{field("order", &T::order)};
  }
};

/// The member has journaled the abort and no longer executes anything of the run.
struct AbortConfirmed {
  static constexpr std::string_view kSubtype = "abort_confirmed";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string run;
  template <class T = AbortConfirmed>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64)};
  }
};

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
  std::string condition;                 ///< as text, with the value that decided if it is known; empty: it has none
  std::string moved_from;                ///< the robot that had it before; empty: it was never moved
  std::vector<std::string> failed_by{};  ///< robots that tried it and failed
  bool twice = false;                    ///< two different FINISHED results: double_execution
  bool due = false;                      ///< no predecessor holds it up any more, and it has not begun
  std::string waits_for{};               ///< when due: what for, as text, if this node knows
  std::string data{};                    ///< the first 1024 bytes of its result
  template <class T = TaskView>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64),
                      field("robot", &T::robot, 64),
                      field("skill", &T::skill, 64),
                      field("state", &T::state),
                      field("outcome", &T::outcome),
                      field("reason", &T::reason, 1024),
                      field("attempt", &T::attempt),
                      field("started", &T::started),
                      field("ended", &T::ended),
                      field("duration_s", &T::duration_s),
                      field("after", &T::after, kMaxTasks),
                      field("condition", &T::condition, 512),
                      field("moved_from", &T::moved_from, 64),
                      field("failed_by", &T::failed_by, 64),
                      field("twice", &T::twice),
                      field("due", &T::due),
                      field("waits_for", &T::waits_for),
                      field("data", &T::data, 1024)};
  }
};

/// A decision, without its proof.
struct DecisionView {
  std::uint32_t epoch = 2;
  std::string by;
  std::string alert;
  std::string person;  ///< empty: the policy
  std::string reason;
  std::int64_t time = 0;
  std::vector<TaskRuling> tasks;
  template <class T = DecisionView>
  static FieldTable fields() {
    return FieldTable{field("epoch", &T::epoch),           field("by", &T::by, 64),
                      field("alert", &T::alert, 64),       field("person", &T::person, 64),
                      field("reason", &T::reason, 1024),   field("time", &T::time),
                      field("tasks", &T::tasks, kMaxTasks)};
  }
};

/// A run as one scheduler knows it; the cloud node's scheduler knows every acknowledged result.
struct RunView {
  static constexpr std::string_view kSubtype = "run_view";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string run;
  std::string name;
  RunState state{};
  std::string waits_for;  ///< when PAUSED or ABORTING: what for, as text
  std::uint32_t epoch = 1;
  std::string submitter;
  std::int64_t created = 0;
  std::int64_t expires = 0;
  std::vector<TaskView> tasks;
  std::vector<DecisionView> decisions;
  std::uint32_t pause_number = 0;  ///< of the pause order in force; 0: there was none
  std::string paused_by;           ///< empty: it is not held
  std::uint32_t priority = 0;
  double left_s = 0;      ///< s left of its time to live
  std::int64_t over = 0;  ///< when this node put it into its archive, UTC ns; 0: it is not over here
  template <class T = RunView>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64),
                      field("name", &T::name, 64),
                      field("state", &T::state),
                      field("waits_for", &T::waits_for, 1024),
                      field("epoch", &T::epoch),
                      field("submitter", &T::submitter, 64),
                      field("created", &T::created),
                      field("expires", &T::expires),
                      field("tasks", &T::tasks, kMaxTasks),
                      field("decisions", &T::decisions, 64),
                      field("pause_number", &T::pause_number),
                      field("paused_by", &T::paused_by, 64),
                      field("priority", &T::priority),
                      field("left_s", &T::left_s),
                      field("over", &T::over)};
  }
};

struct RunQuery {
  static constexpr std::string_view kSubtype = "run_query";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string run;  ///< the id, or a unique beginning of it, or "" for the newest
  template <class T = RunQuery>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64)};
  }
};

/// Requests what is signed of a run, open or over, from its record `first` on (request). Answered by RunRecords.
struct RunProofRequest {
  static constexpr std::string_view kSubtype = "run_proof";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {kProbe, "cloud-gateway"});
  std::string run;          ///< as in RunQuery
  std::uint32_t first = 0;  ///< how many records the requester has
  template <class T = RunProofRequest>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("first", &T::first)};
  }
};

/// A page of a run's signed records: its start, then decisions, orders, choices, results and its end, as far as this
/// node knows them. If `count` has changed since the previous page, the pages do not fit together.
struct RunRecords {
  static constexpr std::string_view kSubtype = "run_records";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"scheduler"});
  std::string run;
  std::uint32_t count = 0;  ///< of all
  std::vector<SignedRecord> records;
  template <class T = RunRecords>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("count", &T::count),
                      field("records", &T::records, kMaxRunRecords)};
  }
};

/// Answered by a RunTable of the runs that are not over here, or, with `all`, by a page of those that are over, newest
/// first.
struct RunListRequest {
  static constexpr std::string_view kSubtype = "run_list";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  bool all = false;
  std::string after;         ///< the last run of the previous page; empty: the first page
  std::uint32_t most = 100;  ///< 1 to 500
  template <class T = RunListRequest>
  static FieldTable fields() {
    return FieldTable{field("all", &T::all), field("after", &T::after, 64), field("most", &T::most)};
  }
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
  std::uint32_t priority = 0;
  double left_s = 0;      ///< s left of its time to live
  std::int64_t over = 0;  ///< as in RunView
  template <class T = RunSummary>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64),
                      field("name", &T::name, 64),
                      field("state", &T::state),
                      field("waits_for", &T::waits_for, 1024),
                      field("created", &T::created),
                      field("tasks", &T::tasks),
                      field("tasks_final", &T::tasks_final),
                      field("epoch", &T::epoch),
                      field("version", &T::version),
                      field("priority", &T::priority),
                      field("left_s", &T::left_s),
                      field("over", &T::over)};
  }
};

/// Requests a scheduler to report on its runs: answered by RunTable at once, then, for `lease_s`, by RunChanged
/// with the same `reply_to` at each change.
struct RunWatch {
  static constexpr std::string_view kSubtype = "run_watch";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  double lease_s = 10;
  template <class T = RunWatch>
  static FieldTable fields() {
    return FieldTable{field("lease_s", &T::lease_s)};
  }
};

/// A run has changed since the last message about it (information, may be lost: the next RunTable has it).
struct RunChanged {
  static constexpr std::string_view kSubtype = "run_changed";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  RunSummary run;
  template <class T = RunChanged>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run)};
  }
};

struct RunTable {
  static constexpr std::string_view kSubtype = "run_table";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::vector<RunSummary> runs;
  bool more = false;           ///< of a page: older runs follow
  std::uint32_t open = 0;      ///< runs that are not over on this node
  std::uint32_t open_max = 0;  ///< how many it accepts
  template <class T = RunTable>
  static FieldTable fields() {
    return FieldTable{field("runs", &T::runs, 1000), field("more", &T::more), field("open", &T::open),
                      field("open_max", &T::open_max)};
  }
};

}  // namespace trb
