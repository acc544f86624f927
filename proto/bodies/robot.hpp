// Bodies about the robot: between scheduler and mode-adapter of one node, and what the fleet is notified of.
#pragma once

#include "proto/field.hpp"
#include "proto/travel.hpp"

namespace trb {

enum class Severity : std::uint8_t { warning = 0, urgent, critical, fatal };
constexpr auto enum_names(Severity) {
  return std::array<std::string_view, 4>{"WARNING", "URGENT", "CRITICAL", "FATAL"};
}

/// How an attempt of a task ended. Only finished and skipped are final; `interrupted`: it is unknown whether it was
/// done; `released`: it never began, and the robot's node has given it back.
enum class TaskOutcome : std::uint8_t { none = 0, finished, failed, retriable, interrupted, skipped, released };
constexpr auto enum_names(TaskOutcome) {
  return std::array<std::string_view, 7>{"none",        "finished", "failed",  "retriable",
                                         "interrupted", "skipped",  "released"};
}

/// Names one attempt of one task of one run: the key for de-duplication.
struct AttemptKey {
  std::string run;
  std::string task;
  std::uint32_t iteration = 1;
  std::uint32_t attempt = 1;
  bool operator==(const AttemptKey&) const = default;
  auto operator<=>(const AttemptKey&) const = default;
  template <class T = AttemptKey>
  static FieldTable fields() {
    return FieldTable{field("run", &T::run, 64), field("task", &T::task, 64), field("iteration", &T::iteration),
                      field("attempt", &T::attempt)};
  }
};

/// Scheduler -> its mode-adapter (command). Answered by ExecutionState "running", or a Nack; the Outcome comes later.
struct Execute {
  static constexpr std::string_view kSubtype = "execute";
  static constexpr Travel kTravel = on_bus(CostPhase::task, {"scheduler"});
  AttemptKey key;
  std::uint32_t epoch = 1;
  std::uint64_t instance = 0;  ///< of the addressed mode-adapter; another one refuses (stale_instance)
  std::string skill;
  std::string data;      ///< the skill's parameters, a JSON object
  double timeout_s = 0;  ///< 0: the value of the description
  template <class T = Execute>
  static FieldTable fields() {
    return FieldTable{field("key", &T::key),         field("epoch", &T::epoch),      field("instance", &T::instance),
                      field("skill", &T::skill, 64), field("data", &T::data, 65536), field("timeout_s", &T::timeout_s)};
  }
};

/// Scheduler -> mode-adapter (command): stop this attempt's motion and report its outcome; does not fence.
struct CancelExecution {
  static constexpr std::string_view kSubtype = "cancel_execution";
  static constexpr Travel kTravel = on_bus(CostPhase::fail, {"scheduler"});
  AttemptKey key;
  std::string reason;
  std::string begun{};  ///< the skill that an earlier process of the mode-adapter may have begun; empty: none
  template <class T = CancelExecution>
  static FieldTable fields() {
    return FieldTable{field("key", &T::key), field("reason", &T::reason, 255), field("begun", &T::begun, 64)};
  }
};

/// Scheduler -> mode-adapter (request): what became of the attempt? Answered by ExecutionState or Outcome.
struct ExecutionQuery {
  static constexpr std::string_view kSubtype = "execution_query";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"scheduler"});
  AttemptKey key;
  template <class T = ExecutionQuery>
  static FieldTable fields() {
    return FieldTable{field("key", &T::key)};
  }
};

/// `state` is "running", or "unknown": this instance never received it.
struct ExecutionState {
  static constexpr std::string_view kSubtype = "execution_state";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"mode-adapter"});
  AttemptKey key;
  std::uint64_t instance = 0;
  std::string state;
  template <class T = ExecutionState>
  static FieldTable fields() {
    return FieldTable{field("key", &T::key), field("instance", &T::instance), field("state", &T::state, 16)};
  }
};

/// Mode-adapter -> scheduler (information), again every second until OutcomeJournaled.
struct Outcome {
  static constexpr std::string_view kSubtype = "outcome";
  static constexpr Travel kTravel = on_bus(CostPhase::task, {"mode-adapter"});
  AttemptKey key;
  std::uint64_t instance = 0;
  TaskOutcome outcome{};
  std::string reason;  ///< why it did not finish, for a person
  std::string data;    ///< the result, JSON text or empty
  double duration_s = 0;
  template <class T = Outcome>
  static FieldTable fields() {
    return FieldTable{field("key", &T::key),          field("instance", &T::instance),
                      field("outcome", &T::outcome),  field("reason", &T::reason, 1024),
                      field("data", &T::data, 65536), field("duration_s", &T::duration_s)};
  }
};

/// Scheduler -> mode-adapter: the outcome is on disk and may be forgotten.
struct OutcomeJournaled {
  static constexpr std::string_view kSubtype = "outcome_journaled";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"scheduler"});
  AttemptKey key;
  template <class T = OutcomeJournaled>
  static FieldTable fields() {
    return FieldTable{field("key", &T::key)};
  }
};

/// What keeps a robot, or one capability of it, out of use until its end is reported or a person ends it.
struct OutOfUse {
  std::string capability;  ///< empty: the whole robot
  Severity severity{};     ///< of the fault
  std::string text;        ///< the robot's own text, or the person's reason
  std::int64_t since = 0;  ///< UTC ns
  bool retired = false;    ///< not a fault: a person has taken it out of service (`trb robot retire`)
  std::string by;          ///< who reported it: a person, or a service of the node; empty: the robot
  bool operator==(const OutOfUse&) const = default;
  template <class T = OutOfUse>
  static FieldTable fields() {
    return FieldTable{field("capability", &T::capability, 64),
                      field("severity", &T::severity),
                      field("text", &T::text, 255),
                      field("since", &T::since),
                      field("retired", &T::retired),
                      field("by", &T::by, 64)};
  }
};

/// One for each capability, one for the whole robot, and one for retirement.
constexpr std::uint32_t kMaxOutOfUse = 66;

/// Takes the robot out of use (command to its mode-adapter; `retired` by a person, or a fault found by a service of the
/// node). Running skills continue. Answered by Ack "out_of_use" once it is on disk, or a Nack. Only the robot's own
/// node and the cloud may send it: no other robot's keys are accepted.
struct TakeOutOfUse {
  static constexpr std::string_view kSubtype = "take_out_of_use";
  static constexpr Travel kTravel = from_cloud(CostPhase::fail, {kProbe, "cloud-gateway", "scheduler"});
  OutOfUse what;
  template <class T = TakeOutOfUse>
  static FieldTable fields() {
    return FieldTable{field("what", &T::what)};
  }
};

/// A person reports that the robot is repaired, or returns it to service (command to its mode-adapter). Answered by Ack
/// "in_use" once it is on disk, or a Nack: conflict, if nothing of that kind kept it out of use.
struct TakeIntoUse {
  static constexpr std::string_view kSubtype = "take_into_use";
  static constexpr Travel kTravel = from_cloud(CostPhase::fail, {kProbe, "cloud-gateway", "resilience"});
  std::string capability;  ///< that is repaired; empty: all of them
  bool retired = false;    ///< `trb robot return`; else `trb robot repaired`
  std::string by;          ///< the person
  template <class T = TakeIntoUse>
  static FieldTable fields() {
    return FieldTable{field("capability", &T::capability, 64), field("retired", &T::retired), field("by", &T::by, 64)};
  }
};

/// What a scheduler has to know about a skill of its robot.
struct SkillUse {
  std::string name;
  std::string capability;   ///< that it needs
  bool repeatable = false;  ///< may be done again if it is unknown whether it was done
  bool operator==(const SkillUse&) const = default;
  template <class T = SkillUse>
  static FieldTable fields() {
    return FieldTable{field("name", &T::name, 64), field("capability", &T::capability, 64),
                      field("repeatable", &T::repeatable)};
  }
};

/// Mode-adapter -> scheduler: at its start, at each change, and in answer to AdapterStateRequest. The paper's "ready".
struct AdapterState {
  static constexpr std::string_view kSubtype = "adapter_state";
  static constexpr Travel kTravel = on_bus(CostPhase::task, {"mode-adapter"});
  std::uint64_t instance = 0;
  std::string robot;  ///< as NodeProfile::robot
  bool fenced = false;
  bool busy = false;
  std::string control;  ///< who else holds the control lease, so that no skill begins; empty: nobody
  std::vector<OutOfUse> out_of_use{};
  std::vector<SkillUse> skills{};
  template <class T = AdapterState>
  static FieldTable fields() {
    return FieldTable{field("instance", &T::instance),   field("robot", &T::robot, 32),
                      field("fenced", &T::fenced),       field("busy", &T::busy),
                      field("control", &T::control, 64), field("out_of_use", &T::out_of_use, kMaxOutOfUse),
                      field("skills", &T::skills, 128)};
  }
};

struct AdapterStateRequest {
  static constexpr std::string_view kSubtype = "adapter_state_request";
  static constexpr Travel kTravel = on_bus(CostPhase::upkeep, {"scheduler"});
  template <class = void>
  static FieldTable fields() {
    return FieldTable{};
  }
};

/// Sent to every node: the robot reports a fault of one capability.
struct RobotFault {
  static constexpr std::string_view kSubtype = "robot_fault";
  static constexpr Travel kTravel = from_robots(CostPhase::fail);
  std::string capability;
  Severity severity{};
  std::string text;    ///< the robot's own text
  bool ended = false;  ///< the robot reports that this fault is over
  template <class T = RobotFault>
  static FieldTable fields() {
    return FieldTable{field("capability", &T::capability, 64), field("severity", &T::severity),
                      field("text", &T::text, 1024), field("ended", &T::ended)};
  }
};

/// One value of a robot: a name of its description's "sensors", and its last value as JSON text.
struct RobotValueTold {
  std::string name;
  std::string value;
  template <class T = RobotValueTold>
  static FieldTable fields() {
    return FieldTable{field("name", &T::name, 64), field("value", &T::value, 1024)};
  }
};

/// Sent to every node: the values of the sensors that the description names, when first received and when one that is
/// not a list has changed, once a second at most.
struct RobotState {
  static constexpr std::string_view kSubtype = "robot_state";
  static constexpr Travel kTravel = from_robots(CostPhase::sensor);
  std::vector<RobotValueTold> values;
  template <class T = RobotState>
  static FieldTable fields() {
    return FieldTable{field("values", &T::values, 32)};
  }
};

/// What of a robot a velocity moves.
enum class DrivePart : std::uint8_t {
  base = 0,  ///< axes x, y, z (m/s; forward, left, up), roll, pitch, yaw (rad/s), in the robot's own frame
  joints,    ///< an axis for each joint, rad/s
  tool,      ///< as base, of the tool in the frame of the arm's foot
  belt,      ///< x, m/s along the belt
};
constexpr auto enum_names(DrivePart) {
  return std::array<std::string_view, 4>{"base", "joints", "tool", "belt"};
}

constexpr std::uint32_t kMaxDriveAxes = 16;

/// A part of a robot that a person can drive.
struct DriveInfo {
  DrivePart part{};
  std::vector<std::string> axes;  ///< their names, in the order of Velocity::speeds
  std::vector<double> limits;     ///< the highest speed of each, m/s or rad/s
  bool operator==(const DriveInfo&) const = default;
  template <class T = DriveInfo>
  static FieldTable fields() {
    return FieldTable{field("part", &T::part), field("axes", &T::axes, kMaxDriveAxes),
                      field("limits", &T::limits, kMaxDriveAxes)};
  }
};

/// A person drives the robot by hand (command to its mode-adapter, several times a second). 250 ms after the last one
/// the robot's node orders it to stand; after 500 ms the drive is over. Answered by Ack "driving" or "over", or a Nack.
struct Velocity {
  static constexpr std::string_view kSubtype = "velocity";
  static constexpr Travel kTravel = from_cloud(CostPhase::task, {kProbe, "cloud-gateway"});
  DrivePart part{};
  std::vector<double> speeds;  ///< of the part's axes (DriveInfo), m/s or rad/s; missing ones are 0
  std::uint64_t drive = 0;     ///< names the drive; a late message of one that is over starts nothing
  std::uint64_t sequence = 0;  ///< increases within a drive; an older one is refused
  bool over = false;           ///< the person lets go: the robot stands, and control is free at once
  bool take = false;           ///< takes control from who has it
  std::string by;              ///< the person
  template <class T = Velocity>
  static FieldTable fields() {
    return FieldTable{field("part", &T::part),   field("speeds", &T::speeds, kMaxDriveAxes),
                      field("drive", &T::drive), field("sequence", &T::sequence),
                      field("over", &T::over),   field("take", &T::take),
                      field("by", &T::by, 64)};
  }
};

/// To the node of a virtual robot (command): make it fail as its maker's robot would. Answered by Ack "handed_over";
/// the robot itself reports the consequences, by RobotFault. A robot that is not virtual refuses it (not_permitted).
struct InjectFault {
  static constexpr std::string_view kSubtype = "inject_fault";
  static constexpr Travel kTravel = between_nodes(CostPhase::fail);
  std::string capability;  ///< empty: every injected fault is over
  Severity severity{};
  std::string text;  ///< the robot's own text
  template <class T = InjectFault>
  static FieldTable fields() {
    return FieldTable{field("capability", &T::capability, 64), field("severity", &T::severity),
                      field("text", &T::text, 1024)};
  }
};

/// Sent to every node: the robot's connection changed.
struct RobotConnection {
  static constexpr std::string_view kSubtype = "robot_connection";
  static constexpr Travel kTravel = from_robots(CostPhase::fail);
  std::string state;  ///< as NodeProfile::robot
  std::string detail;
  template <class T = RobotConnection>
  static FieldTable fields() {
    return FieldTable{field("state", &T::state, 32), field("detail", &T::detail, 255)};
  }
};

/// Stops the robot and fences it until Release. From any member of the fleet. Answered by Ack "stopped".
/// Not a safety function (ISO 13850, ISO 10218).
struct Stop {
  static constexpr std::string_view kSubtype = "stop";
  static constexpr Travel kTravel = between_nodes(CostPhase::fail);
  std::string reason;
  template <class T = Stop>
  static FieldTable fields() {
    return FieldTable{field("reason", &T::reason, 255)};
  }
};

/// Lifts the fence. Answered by Ack "released".
struct Release {
  static constexpr std::string_view kSubtype = "release";
  static constexpr Travel kTravel = between_nodes(CostPhase::fail);
  std::string reason;
  template <class T = Release>
  static FieldTable fields() {
    return FieldTable{field("reason", &T::reason, 255)};
  }
};

}  // namespace trb
