// Records of the scheduler's journal. They are never sent; the rules for fields (append only) hold for them, too. Their
// kinds are reserved (proto/travel.cpp): no user's subtype is taken for one.
#pragma once

#include <any>
#include <variant>

#include "proto/body.hpp"

namespace trb::scheduler {

/// The run is known on this node: the signed RunStart.
struct JournalRun {
  static constexpr std::string_view kKind = "journal_run";
  SignedRecord start;
  bool submitted_here = false;  ///< this scheduler owes the batons to the first actors
  template <class T = JournalRun>
  static FieldTable fields() {
    return FieldTable{field("start", &T::start), field("submitted_here", &T::submitted_here)};
  }
};

/// Written before the robot is commanded.
struct JournalStart {
  static constexpr std::string_view kKind = "journal_start";
  AttemptKey key;
  std::uint32_t epoch = 1;
  std::uint64_t instance = 0;  ///< of the mode-adapter that is to execute it
  std::int64_t time = 0;       ///< UTC ns
  template <class T = JournalStart>
  static FieldTable fields() {
    return FieldTable{field("key", &T::key), field("epoch", &T::epoch), field("instance", &T::instance),
                      field("time", &T::time)};
  }
};

/// A signed result: this node's own, or another's.
struct JournalResult {
  static constexpr std::string_view kKind = "journal_result";
  SignedRecord result;
  template <class T = JournalResult>
  static FieldTable fields() {
    return FieldTable{field("result", &T::result)};
  }
};

/// A signed choice on tasks' conditions: this node's own, or another's.
struct JournalChoice {
  static constexpr std::string_view kKind = "journal_choice";
  SignedRecord choice;
  template <class T = JournalChoice>
  static FieldTable fields() {
    return FieldTable{field("choice", &T::choice)};
  }
};

/// Of JournalDelivered: this node learned of the run from a member, and asks all of them what they hold of it; a member
/// has told all (if it is this node: nobody needs to be asked); the submitter says that it is new. Earlier versions
/// ignore them.
inline constexpr std::string_view kRecovers = "recovers";
inline constexpr std::string_view kHasTold = "has_told";
inline constexpr std::string_view kFirstPass = "first_pass";

/// Another node has journaled what this node owed it, or told it all that it holds.
struct JournalDelivered {
  static constexpr std::string_view kKind = "journal_delivered";
  std::string run;
  std::string to;
  std::string what;  ///< "baton", "results", "abort", "decision", "pause"; kRecovers, kHasTold, kFirstPass
  std::vector<std::uint16_t> tasks;
  std::uint32_t epoch = 1;
  template <class T = JournalDelivered>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("to", &T::to, 64), field("what", &T::what, 16),
                      field("tasks", &T::tasks, kMaxTasks), field("epoch", &T::epoch)};
  }
};

/// The run was aborted: the signed AbortOrder.
struct JournalAbort {
  static constexpr std::string_view kKind = "journal_abort";
  SignedRecord order;
  bool ordered_here = false;  ///< this scheduler owes the order to the members
  template <class T = JournalAbort>
  static FieldTable fields() {
    return FieldTable{field("order", &T::order), field("ordered_here", &T::ordered_here)};
  }
};

/// The run's next epoch: the signed Decision.
struct JournalDecision {
  static constexpr std::string_view kKind = "journal_decision";
  SignedRecord decision;
  bool decided_here = false;  ///< this scheduler owes it to the members
  template <class T = JournalDecision>
  static FieldTable fields() {
    return FieldTable{field("decision", &T::decision), field("decided_here", &T::decided_here)};
  }
};

/// The run is held or goes on: the signed PauseOrder.
struct JournalPause {
  static constexpr std::string_view kKind = "journal_pause";
  SignedRecord order;
  bool ordered_here = false;  ///< this scheduler owes the order to the members
  template <class T = JournalPause>
  static FieldTable fields() {
    return FieldTable{field("order", &T::order), field("ordered_here", &T::ordered_here)};
  }
};

/// The run has FINISHED: the signed RunEnd.
struct JournalEnd {
  static constexpr std::string_view kKind = "journal_end";
  SignedRecord end;
  template <class T = JournalEnd>
  static FieldTable fields() {
    return FieldTable{field("end", &T::end)};
  }
};

/// The run is over: its records are dropped, and this one is kept in the archive instead; until `until`, any message
/// that still arrives for the run is refused.
struct JournalArchive {
  static constexpr std::string_view kKind = "journal_archive";
  RunView view;
  std::vector<SignedRecord> results;  ///< those that count, then the others of what was done twice
  std::vector<SignedRecord> choices;
  std::vector<SignedRecord> decisions;
  std::vector<SignedRecord> orders;
  SignedRecord end;        ///< the RunEnd; an empty kind: there is none
  std::int64_t until = 0;  ///< by the node's steady time, UTC ns
  SignedRecord start{};    ///< the RunStart; an empty kind: an earlier version wrote the record
  template <class T = JournalArchive>
  static FieldTable fields() {
    return FieldTable{field("view", &T::view),
                      field("results", &T::results, kMaxTasks),
                      field("choices", &T::choices, kMaxTasks),
                      field("decisions", &T::decisions, 64),
                      field("orders", &T::orders, kMaxOrders),
                      field("end", &T::end),
                      field("until", &T::until),
                      field("start", &T::start)};
  }
};

/// The node's steady time (common/base/steady_time.hpp), written now and then. The newest record counts.
struct JournalTime {
  static constexpr std::string_view kKind = "journal_time";
  std::int64_t steady = 0;  ///< UTC ns
  template <class T = JournalTime>
  static FieldTable fields() {
    return FieldTable{field("steady", &T::steady)};
  }
};

/// This journal is new although the node is not: the content of the older one is lost, and no task begins before a
/// person has looked at the robot. `over`: a person has. `time`: after the loss; 0: the clock cannot be trusted yet.
struct JournalLost {
  static constexpr std::string_view kKind = "journal_lost";
  std::int64_t time = 0;  ///< UTC ns
  bool over = false;
  template <class T = JournalLost>
  static FieldTable fields() {
    return FieldTable{field("time", &T::time), field("over", &T::over)};
  }
};

/// Written by an earlier version. The run is over; its records are dropped, and until `until` any message that still
/// arrives for it is refused.
struct JournalTombstone {
  static constexpr std::string_view kKind = "journal_tombstone";
  std::string run;
  RunState state{};
  std::int64_t until = 0;  ///< UTC ns
  template <class T = JournalTombstone>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("state", &T::state), field("until", &T::until)};
  }
};

/// Every kind; the order means nothing on disk.
using JournalRecord =
    std::variant<JournalRun, JournalStart, JournalResult, JournalChoice, JournalDelivered, JournalAbort,
                 JournalDecision, JournalPause, JournalEnd, JournalArchive, JournalTime, JournalLost, JournalTombstone>;

std::string_view kind_of(const JournalRecord& record);

/// As encode() and decode() of a body (proto/body.hpp), but as long as a row of the file. Errors: bad_value (no such
/// kind), those of decode().
Bytes encode_record(const JournalRecord& record);
Result<JournalRecord> decode_record(std::string_view kind, BytesView bytes);

/// What a core has recorded (Journal::record). Error: bad_value, it is another service's.
Result<JournalRecord> to_journal_record(const std::any& recorded);

/// The run that a journal record is about; empty: the whole journal. Errors: bad_value (one that no journal has any
/// more), malformed.
Result<std::string> run_of(const JournalRecord& record);

/// The run that a signed record's content names. Error: malformed.
template <class Content>
Result<std::string> run_inside(const SignedRecord& record) {
  const auto content = decode<Content>(record.payload.bytes);
  if (!content) return content.error();
  if constexpr (requires { content->key.run; }) {
    return content->key.run;
  } else {
    return content->run;
  }
}

}  // namespace trb::scheduler
