// Bodies of trb-resilience: alerts, the ranked ways to resolve them, and what a person decides.
#pragma once

#include "proto/bodies/robot.hpp"
#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

/// How much one criterion contributes to a candidate's score.
struct CriterionPart {
  std::string criterion;
  double value = 0;  ///< as measured
  std::string unit;
  double weight = 0;        ///< the criterion's weight among all
  double contribution = 0;  ///< to the score; the contributions add up to it
  std::string robot{};      ///< the robot that this part is about
  bool operator==(const CriterionPart&) const = default;
  template <class T = CriterionPart>
  static FieldTable fields() {
    return FieldTable{field("criterion", &T::criterion, 64),
                      field("value", &T::value),
                      field("unit", &T::unit, 16),
                      field("weight", &T::weight),
                      field("contribution", &T::contribution),
                      field("robot", &T::robot, 64)};
  }
};

struct TaskForRobot {
  std::string task;
  std::string robot;
  bool operator==(const TaskForRobot&) const = default;
  template <class T = TaskForRobot>
  static FieldTable fields() {
    return FieldTable{field("task", &T::task, 64), field("robot", &T::robot, 64)};
  }
};

/// One way to resolve an alert: who takes over which tasks. The best has the highest score.
struct Proposal {
  std::string robot;  ///< that takes over all of them; empty: several robots share them
  std::vector<TaskForRobot> tasks;
  double score = 0;                  ///< the scores of an alert's proposals add up to 1; of several robots: the mean
  std::vector<CriterionPart> parts;  ///< of `robot`, or of the tasks' robots in their order
  std::string note;                  ///< what a person should know, such as that a value is old
  double merit = 0;                  ///< 0 to 1: compared with the best possible, not with the other proposals
  bool operator==(const Proposal&) const = default;
  template <class T = Proposal>
  static FieldTable fields() {
    return FieldTable{field("robot", &T::robot, 64),  field("tasks", &T::tasks, 1000), field("score", &T::score),
                      field("parts", &T::parts, 256), field("note", &T::note, 512),    field("merit", &T::merit)};
  }
};

/// A robot that was considered and cannot do it.
struct Unfit {
  std::string robot;
  std::string why;
  bool operator==(const Unfit&) const = default;
  template <class T = Unfit>
  static FieldTable fields() {
    return FieldTable{field("robot", &T::robot, 64), field("why", &T::why)};
  }
};

/// OPEN: waits for a verdict. RELEASING: decided; the failed robot has to give its tasks back. DECIDED: the decision is
/// signed and sent on. EXPIRED: nobody answered in time; it can still be decided, with new proposals. CLOSED: its cause
/// is gone, or its run is over.
enum class AlertState : std::uint8_t { open = 0, releasing, decided, expired, closed };
constexpr auto enum_names(AlertState) {
  return std::array<std::string_view, 5>{"OPEN", "RELEASING", "DECIDED", "EXPIRED", "CLOSED"};
}

/// The verdict of a person or of the policy.
enum class Verdict : std::uint8_t { none = 0, accept, override_, retry, skip, abort };
constexpr auto enum_names(Verdict) {
  return std::array<std::string_view, 6>{"none", "accept", "override", "retry", "skip", "abort"};
}

/// A robot cannot do what a run needs from it.
struct Alert {
  static constexpr std::string_view kSubtype = "alert";
  static constexpr Travel kTravel = in_record();
  std::string id;    ///< 16 hexadecimal digits
  std::string run;   ///< empty: no run needs the robot; reported nevertheless
  std::string name;  ///< the run's
  std::string robot;
  std::string capability;  ///< the capability that is gone; empty: the whole robot
  Severity severity{};
  std::string cause;  ///< "robot_fault", "robot_retired", "robot_connection", "peer_expired", "task_failed",
                      ///< "task_interrupted", "task_overdue", "robot_wanted", "double_execution", "run_ends", "asked"
  std::string text;   ///< the robot's or the node's own text
  std::vector<std::string> tasks;  ///< tasks of the run that cannot go on with this robot
  std::int64_t time = 0;           ///< UTC ns
  std::int64_t expires = 0;        ///< when the proposals expire: UTC ns
  AlertState state{};
  std::vector<Proposal> proposals;  ///< best first
  std::vector<Unfit> unfit;
  std::string policy;       ///< "ask", or "automatic" and, if a person is asked nevertheless, why
  bool needs_word = false;  ///< the robot's state is unknown: a person must confirm that it stands still
  Verdict verdict{};
  std::string person;
  std::string reason;
  std::uint32_t epoch = 0;  ///< the epoch that the decision begins; 0: no decision yet
  std::string waits_for;    ///< as text
  bool operator==(const Alert&) const = default;
  template <class T = Alert>
  static FieldTable fields() {
    return FieldTable{field("id", &T::id, 64),
                      field("run", &T::run, 64),
                      field("name", &T::name, 64),
                      field("robot", &T::robot, 64),
                      field("capability", &T::capability, 64),
                      field("severity", &T::severity),
                      field("cause", &T::cause, 32),
                      field("text", &T::text, 1024),
                      field("tasks", &T::tasks, 1000),
                      field("time", &T::time),
                      field("expires", &T::expires),
                      field("state", &T::state),
                      field("proposals", &T::proposals, 64),
                      field("unfit", &T::unfit, 64),
                      field("policy", &T::policy),
                      field("needs_word", &T::needs_word),
                      field("verdict", &T::verdict),
                      field("person", &T::person, 64),
                      field("reason", &T::reason, 1024),
                      field("epoch", &T::epoch),
                      field("waits_for", &T::waits_for, 512)};
  }
};

struct AlertListRequest {
  static constexpr std::string_view kSubtype = "alert_list";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  bool all = false;  ///< also alerts that are DECIDED or CLOSED
  template <class T = AlertListRequest>
  static FieldTable fields() {
    return FieldTable{field("all", &T::all)};
  }
};

struct AlertTable {
  static constexpr std::string_view kSubtype = "alert_table";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::vector<Alert> alerts;  ///< newest first
  template <class T = AlertTable>
  static FieldTable fields() {
    return FieldTable{field("alerts", &T::alerts, 256)};
  }
};

/// A verdict on an alert, or on a run's tasks (command): by a person on a node's own bus, or by one on another cloud
/// node, which then names the run and its tasks. Answered by Ack "accepted" once journaled, by DecidedElsewhere, or a
/// Nack.
struct AlertDecide {
  static constexpr std::string_view kSubtype = "alert_decide";
  static constexpr Travel kTravel = from_cloud(CostPhase::upkeep, {kProbe, "cloud-gateway"});
  std::string alert;  ///< the id, or a unique beginning of it
  Verdict verdict{};
  std::string robot;  ///< accept: the robot of the proposal, empty for the best; override: the robot that takes over
  std::string person;
  std::string reason;                 ///< an override needs one
  bool stands = false;                ///< the person confirms that the failed robot stands still
  std::string run{};                  ///< without an alert: the run (or a unique beginning of its id) ...
  std::vector<std::string> tasks{};   ///< ... and its tasks; with an alert: which of its tasks are meant, empty: all
  std::vector<TaskForRobot> shown{};  ///< accept: the proposal as the person saw it; no task goes to another robot.
                                      ///< Empty: whatever is proposed now
  template <class T = AlertDecide>
  static FieldTable fields() {
    return FieldTable{
        field("alert", &T::alert, 64),   field("verdict", &T::verdict),     field("robot", &T::robot, 64),
        field("person", &T::person, 64), field("reason", &T::reason, 1024), field("stands", &T::stands),
        field("run", &T::run, 64),       field("tasks", &T::tasks, 1000),   field("shown", &T::shown, 1000)};
  }
};

/// Answers a verdict on a run that another node decides on: the verdict belongs there, on this run and these tasks.
/// Alerts have other ids on other nodes.
struct DecidedElsewhere {
  static constexpr std::string_view kSubtype = "decided_elsewhere";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"resilience"});
  std::string node;
  std::string run;
  std::vector<std::string> tasks;
  template <class T = DecidedElsewhere>
  static FieldTable fields() {
    return FieldTable{field("node", &T::node, 64), field("run", &T::run, 64), field("tasks", &T::tasks, 1000)};
  }
};

/// How much a criterion counts.
struct WeighedCriterion {
  std::string criterion;
  double weight = 0;
  bool operator==(const WeighedCriterion&) const = default;
  template <class T = WeighedCriterion>
  static FieldTable fields() {
    return FieldTable{field("criterion", &T::criterion, 64), field("weight", &T::weight)};
  }
};

/// If a criterion's weight passes this value, coming from its present one, another robot is first.
struct WeightFlip {
  std::string criterion;
  double weight = 0;  ///< 0 to 1, a share of all
  std::string winner;
  bool operator==(const WeightFlip&) const = default;
  template <class T = WeightFlip>
  static FieldTable fields() {
    return FieldTable{field("criterion", &T::criterion, 64), field("weight", &T::weight),
                      field("winner", &T::winner, 64)};
  }
};

constexpr std::uint32_t kMaxRankedCriteria = 16;

/// How would an open alert's candidates be ranked by other weights? On the decider's own bus. Values that are old are
/// requested from the robots. Answered by AlertRanking at once, or a Nack; the alert stays as it is.
struct AlertRankRequest {
  static constexpr std::string_view kSubtype = "alert_rank";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {kProbe, "cloud-gateway"});
  std::string alert;                      ///< the id, or a unique beginning of it
  std::vector<WeighedCriterion> weights;  ///< only their ratio counts; one that is left out counts nothing; empty:
                                          ///< those in force
  template <class T = AlertRankRequest>
  static FieldTable fields() {
    return FieldTable{field("alert", &T::alert, 64), field("weights", &T::weights, kMaxRankedCriteria)};
  }
};

struct AlertRanking {
  static constexpr std::string_view kSubtype = "alert_ranking";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"resilience"});
  std::string alert;
  std::vector<WeighedCriterion> weights;  ///< shares of all
  std::vector<Proposal> proposals;        ///< best first
  std::vector<Unfit> unfit;
  std::vector<WeightFlip> flips;  ///< by criterion, then weight
  bool complete = false;          ///< no robot's answer is awaited
  template <class T = AlertRanking>
  static FieldTable fields() {
    return FieldTable{field("alert", &T::alert, 64),         field("weights", &T::weights, kMaxRankedCriteria),
                      field("proposals", &T::proposals, 64), field("unfit", &T::unfit, 64),
                      field("flips", &T::flips, 512),        field("complete", &T::complete)};
  }
};

/// Requests what a node's trb-resilience has recorded about its fleet's robots.
struct HistoryListRequest {
  static constexpr std::string_view kSubtype = "history_list";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::string robot;         ///< empty: all robots
  std::uint32_t most = 100;  ///< events: 1 to 500
  template <class T = HistoryListRequest>
  static FieldTable fields() {
    return FieldTable{field("robot", &T::robot, 64), field("most", &T::most)};
  }
};

/// Something that happened to a robot.
struct RobotEvent {
  std::int64_t time = 0;  ///< UTC ns, when the node that reports it learnt of it
  std::string robot;
  std::string kind;  ///< joined, expired, connection, fenced, released, profile, fault, fault_ended, retired, returned,
                     ///< forgotten
  std::string text;
  template <class T = RobotEvent>
  static FieldTable fields() {
    return FieldTable{field("time", &T::time), field("robot", &T::robot, 64), field("kind", &T::kind, 32),
                      field("text", &T::text, 255)};
  }
};

struct HistoryTable {
  static constexpr std::string_view kSubtype = "history_table";
  static constexpr Travel kTravel = between_nodes(CostPhase::upkeep);
  std::vector<RobotEvent> events;  ///< newest first
  template <class T = HistoryTable>
  static FieldTable fields() {
    return FieldTable{field("events", &T::events, 500)};
  }
};

}  // namespace trb
