// Bodies of trb-resilience: alerts, the ranked ways out of them, and what a person decides.
#pragma once

#include "proto/bodies/robot.hpp"
#include "proto/field.hpp"

namespace trb {

/// One criterion's part in a candidate's score.
struct CriterionPart {
  std::string criterion;
  double value = 0;  ///< as measured
  std::string unit;
  double weight = 0;        ///< of the criterion, among all
  double contribution = 0;  ///< to the score; they add up to it
  bool operator==(const CriterionPart&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("criterion", &CriterionPart::criterion, 64), field("value", &CriterionPart::value),
                      field("unit", &CriterionPart::unit, 16), field("weight", &CriterionPart::weight),
                      field("contribution", &CriterionPart::contribution)};
  }
};

struct TaskForRobot {
  std::string task;
  std::string robot;
  bool operator==(const TaskForRobot&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("task", &TaskForRobot::task, 64), field("robot", &TaskForRobot::robot, 64)};
  }
};

/// One way out: who takes over which tasks. The best has the highest score.
struct Proposal {
  std::string robot;  ///< that takes over all of them; empty: several between them
  std::vector<TaskForRobot> tasks;
  double score = 0;                  ///< the scores of an alert's proposals add up to 1; of several robots, their mean
  std::vector<CriterionPart> parts;  ///< of `robot`, or of the tasks' robots in their order
  std::string note;                  ///< what a person should know, as a value that is old
  bool operator==(const Proposal&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("robot", &Proposal::robot, 64), field("tasks", &Proposal::tasks, 1000),
                      field("score", &Proposal::score), field("parts", &Proposal::parts, 256),
                      field("note", &Proposal::note, 512)};
  }
};

/// A robot that was looked at and cannot do it.
struct Unfit {
  std::string robot;
  std::string why;
  bool operator==(const Unfit&) const = default;
  static constexpr auto fields() { return std::tuple{field("robot", &Unfit::robot, 64), field("why", &Unfit::why)}; }
};

/// OPEN: waits for a word. RELEASING: decided; the failed robot is to give its tasks back. DECIDED: the decision is
/// signed and handed on. EXPIRED: nobody answered in time; it can still be decided, on new proposals. CLOSED: its cause
/// is gone, or its run is over.
enum class AlertState : std::uint8_t { open = 0, releasing, decided, expired, closed };
constexpr auto enum_names(AlertState) {
  return std::array<std::string_view, 5>{"OPEN", "RELEASING", "DECIDED", "EXPIRED", "CLOSED"};
}

/// What a person, or the policy, has said of it.
enum class Verdict : std::uint8_t { none = 0, accept, override_, retry, skip, abort };
constexpr auto enum_names(Verdict) {
  return std::array<std::string_view, 6>{"none", "accept", "override", "retry", "skip", "abort"};
}

/// A robot cannot do what a run needs of it.
struct Alert {
  static constexpr std::string_view kSubtype = "alert";
  std::string id;    ///< 16 hexadecimal digits
  std::string run;   ///< empty: no run needs the robot; told all the same
  std::string name;  ///< the run's
  std::string robot;
  std::string capability;  ///< that is gone; empty: the whole robot
  Severity severity{};
  std::string cause;  ///< "robot_fault", "robot_connection", "peer_expired", "task_failed", "task_interrupted"
  std::string text;   ///< the robot's or the node's own words
  std::vector<std::string> tasks;  ///< of the run, that cannot go on with this robot
  std::int64_t time = 0;           ///< UTC ns
  std::int64_t expires = 0;        ///< of the proposals: UTC ns
  AlertState state{};
  std::vector<Proposal> proposals;  ///< best first
  std::vector<Unfit> unfit;
  std::string policy;       ///< "ask", or "automatic" and, if it asks all the same, why
  bool needs_word = false;  ///< the robot is silent, or nobody knows what it does: a person must say that it stands
  Verdict verdict{};
  std::string person;
  std::string reason;
  std::uint32_t epoch = 0;  ///< of the decision; 0: none yet
  std::string waits_for;    ///< in words
  bool operator==(const Alert&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("id", &Alert::id, 64),
                      field("run", &Alert::run, 64),
                      field("name", &Alert::name, 64),
                      field("robot", &Alert::robot, 64),
                      field("capability", &Alert::capability, 64),
                      field("severity", &Alert::severity),
                      field("cause", &Alert::cause, 32),
                      field("text", &Alert::text, 1024),
                      field("tasks", &Alert::tasks, 1000),
                      field("time", &Alert::time),
                      field("expires", &Alert::expires),
                      field("state", &Alert::state),
                      field("proposals", &Alert::proposals, 64),
                      field("unfit", &Alert::unfit, 64),
                      field("policy", &Alert::policy),
                      field("needs_word", &Alert::needs_word),
                      field("verdict", &Alert::verdict),
                      field("person", &Alert::person, 64),
                      field("reason", &Alert::reason, 1024),
                      field("epoch", &Alert::epoch),
                      field("waits_for", &Alert::waits_for, 512)};
  }
};

struct AlertListRequest {
  static constexpr std::string_view kSubtype = "alert_list";
  bool all = false;  ///< also those that are DECIDED or CLOSED
  static constexpr auto fields() { return std::tuple{field("all", &AlertListRequest::all)}; }
};

struct AlertTable {
  static constexpr std::string_view kSubtype = "alert_table";
  std::vector<Alert> alerts;  ///< newest first
  static constexpr auto fields() { return std::tuple{field("alerts", &AlertTable::alerts, 256)}; }
};

/// A verdict on an alert (command), on the decider's own bus. Answered by Ack "accepted" once journaled, or a Nack.
struct AlertDecide {
  static constexpr std::string_view kSubtype = "alert_decide";
  std::string alert;  ///< the id, or a unique beginning of it
  Verdict verdict{};
  std::string robot;  ///< accept: the proposal's robot, empty for the best; override: the robot that takes over
  std::string person;
  std::string reason;   ///< an override needs one
  bool stands = false;  ///< the person's word that the failed robot stands
  static constexpr auto fields() {
    return std::tuple{field("alert", &AlertDecide::alert, 64),     field("verdict", &AlertDecide::verdict),
                      field("robot", &AlertDecide::robot, 64),     field("person", &AlertDecide::person, 64),
                      field("reason", &AlertDecide::reason, 1024), field("stands", &AlertDecide::stands)};
  }
};

/// Asks a node's trb-resilience what it has seen of its fleet's robots.
struct HistoryListRequest {
  static constexpr std::string_view kSubtype = "history_list";
  std::string robot;         ///< empty: of every one
  std::uint32_t most = 100;  ///< events: 1 to 500
  static constexpr auto fields() {
    return std::tuple{field("robot", &HistoryListRequest::robot, 64), field("most", &HistoryListRequest::most)};
  }
};

/// Something that happened to a robot.
struct RobotEvent {
  std::int64_t time = 0;  ///< UTC ns, as the node that tells it learnt of it
  std::string robot;
  std::string kind;  ///< joined, expired, connection, fenced, released, profile, fault, fault_ended, forgotten
  std::string text;
  static constexpr auto fields() {
    return std::tuple{field("time", &RobotEvent::time), field("robot", &RobotEvent::robot, 64),
                      field("kind", &RobotEvent::kind, 32), field("text", &RobotEvent::text, 255)};
  }
};

struct HistoryTable {
  static constexpr std::string_view kSubtype = "history_table";
  std::vector<RobotEvent> events;  ///< newest first
  static constexpr auto fields() { return std::tuple{field("events", &HistoryTable::events, 500)}; }
};

}  // namespace trb
