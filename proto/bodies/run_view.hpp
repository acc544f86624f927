// A run as people ask for it: views, tables, and the records that prove it.
#pragma once

#include "proto/bodies/run_exchange.hpp"

namespace trb {

/// Start, end, 64 decisions, the orders, and a choice and a result for each task are fewer.
constexpr std::uint32_t kMaxRunRecords = 4000;

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
  /// This node, its judge, may have lost what it knew: it asks the members, and takes no decision before they have
  /// told.
  bool recovers = false;
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
                      field("over", &T::over),
                      field("recovers", &T::recovers)};
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
  bool recovers = false;  ///< as in RunView
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
                      field("over", &T::over),
                      field("recovers", &T::recovers)};
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
