// Decisions on a run, signed by its decider, each beginning the next epoch; and what schedulers exchange about them.
#pragma once

#include "proto/bodies/signed.hpp"
#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

/// A node that takes part in the run, with the certificate that checks its signatures.
struct Member {
  std::string id;
  SignedRecord certificate;
  bool operator==(const Member&) const = default;
  template <class T = Member>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64), field("certificate", &T::certificate)};
  }
};

/// What a decision does with one task. `move`: another robot does it. `retry`: the same robot does it again. `skip`:
/// the decider's node becomes its actor and reports it as SKIPPED.
enum class Ruling : std::uint8_t { move = 0, retry, skip };
constexpr auto enum_names(Ruling) {
  return std::array<std::string_view, 3>{"move", "retry", "skip"};
}

/// Why the task may leave its robot, or be done again. `result`: the robot's own signed result shows that the attempt
/// has ended or never began. `word`: a person has confirmed that the robot stands still; or the scenario skips the task
/// if it does not begin in time.
enum class Evidence : std::uint8_t { result = 0, word };
constexpr auto enum_names(Evidence) {
  return std::array<std::string_view, 2>{"result", "word"};
}

struct TaskRuling {
  std::string task;
  Ruling ruling{};
  std::string robot;          ///< the robot that has the task from this epoch on
  std::uint32_t attempt = 1;  ///< the next attempt: earlier ones are void unless they FINISHED
  Evidence evidence{};
  bool operator==(const TaskRuling&) const = default;
  template <class T = TaskRuling>
  static FieldTable fields() {
    return FieldTable{field("task", &T::task, 64), field("ruling", &T::ruling), field("robot", &T::robot, 64),
                      field("attempt", &T::attempt), field("evidence", &T::evidence)};
  }
};

/// Epoch k+1 of a run, signed by its decider (purpose "decision"): the first cloud node among the start's members.
/// Whatever it does not name stays as it was.
struct Decision {
  static constexpr std::string_view kSubtype = "decision";
  static constexpr Travel kTravel = in_record();
  std::string run;
  Blob digest;
  std::uint32_t epoch = 2;
  Blob previous;  ///< BLAKE2b-256 of the previous decision's payload; empty in epoch 2
  std::string by;
  std::vector<TaskRuling> tasks;
  std::vector<Member> members;  ///< those that were not members before
  std::string alert;            ///< the alert that it answers
  std::string person;           ///< who decided; empty: the policy
  std::string reason;
  std::int64_t time = 0;  ///< UTC ns
  bool operator==(const Decision&) const = default;
  template <class T = Decision>
  static FieldTable fields() {
    return FieldTable{
        field("run", &T::run, 64),           field("digest", &T::digest, 32), field("epoch", &T::epoch),
        field("previous", &T::previous, 32), field("by", &T::by, 64),         field("tasks", &T::tasks, 1000),
        field("members", &T::members, 1000), field("alert", &T::alert, 64),   field("person", &T::person, 64),
        field("reason", &T::reason, 1024),   field("time", &T::time)};
  }
};

/// Carries a decision (command): from the decider's own bus to its scheduler, answered by Ack or Nack once journaled;
/// and from there to a member, resent until DecisionJournaled.
struct RunDecision {
  static constexpr std::string_view kSubtype = "run_decision";
  static constexpr Travel kTravel = from_cloud(CostPhase::fail, {"resilience", "scheduler"});
  SignedRecord decision;
  template <class T = RunDecision>
  static FieldTable fields() {
    return FieldTable{field("decision", &T::decision)};
  }
};

/// The member has every decision up to that epoch on disk.
struct DecisionJournaled {
  static constexpr std::string_view kSubtype = "decision_journaled";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string run;
  std::uint32_t epoch = 1;
  template <class T = DecisionJournaled>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("epoch", &T::epoch)};
  }
};

/// A decider requests a robot's node to give tasks back (command). A task that has not begun is answered by its signed
/// result, `released`; one that has ended stays as it is, and so does a running one unless it is to stop. Answered by
/// Ack "accepted" or a Nack; the results come as usual.
struct ReleaseTasks {
  static constexpr std::string_view kSubtype = "release_tasks";
  static constexpr Travel kTravel = from_cloud(CostPhase::fail, {"resilience"});
  std::string run;
  std::uint32_t epoch = 1;
  std::vector<std::uint16_t> tasks;
  bool stop{};  ///< running tasks end as `retriable`: a person has confirmed that the robot stands still
  template <class T = ReleaseTasks>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("epoch", &T::epoch), field("tasks", &T::tasks, 1000),
                      field("stop", &T::stop)};
  }
};

/// The order to hold a run, or to let it continue, signed (purpose "run_pause"). The highest number counts; of two
/// orders with the same number, the one that holds the run.
struct PauseOrder {
  static constexpr std::string_view kSubtype = "pause_order";
  static constexpr Travel kTravel = in_record();
  std::string run;
  std::uint32_t number = 1;
  bool paused = true;
  std::string by;
  std::string reason;
  std::int64_t time = 0;               ///< UTC ns
  std::vector<std::string> doubles{};  ///< tasks known to have been done twice: they no longer hold the run
  template <class T = PauseOrder>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64),          field("number", &T::number),
                      field("paused", &T::paused),        field("by", &T::by, 64),
                      field("reason", &T::reason, 255),   field("time", &T::time),
                      field("doubles", &T::doubles, 1000)};
  }
};

/// Carries a PauseOrder to a member (command); resent until PauseJournaled.
struct RunPause {
  static constexpr std::string_view kSubtype = "run_pause";
  static constexpr Travel kTravel = between_nodes(CostPhase::fail);
  SignedRecord order;
  template <class T = RunPause>
  static FieldTable fields() {
    return FieldTable{field("order", &T::order)};
  }
};

struct PauseJournaled {
  static constexpr std::string_view kSubtype = "pause_journaled";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string run;
  std::uint32_t number = 1;
  template <class T = PauseJournaled>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("number", &T::number)};
  }
};

}  // namespace trb
