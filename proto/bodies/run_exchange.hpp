// What schedulers send each other of a run, from its submission to its end.
#pragma once

#include "proto/bodies/run.hpp"

namespace trb {

/// Orders that count for a run: one to hold it or let it continue, one to abort it.
constexpr std::uint32_t kMaxOrders = 2;
constexpr std::uint32_t kMaxShortForm = 1U << 19U;

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

}  // namespace trb
