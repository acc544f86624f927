// Bodies about the robot: between scheduler and mode-adapter of one node, and what is told to the fleet.
#pragma once

#include "proto/field.hpp"

namespace trb {

enum class Severity : std::uint8_t { warning = 0, urgent, critical, fatal };
constexpr auto enum_names(Severity) {
  return std::array<std::string_view, 4>{"WARNING", "URGENT", "CRITICAL", "FATAL"};
}

/// How an attempt of a task ended. Only finished and skipped are final; `interrupted`: nobody knows whether it was
/// done; `released`: it was never begun, and the robot's node has given it back.
enum class TaskOutcome : std::uint8_t { none = 0, finished, failed, retriable, interrupted, skipped, released };
constexpr auto enum_names(TaskOutcome) {
  return std::array<std::string_view, 7>{"none",        "finished", "failed",  "retriable",
                                         "interrupted", "skipped",  "released"};
}

/// Names one attempt of one task of one run: the key by which everything is de-duplicated.
struct AttemptKey {
  std::string run;
  std::string task;
  std::uint32_t iteration = 1;
  std::uint32_t attempt = 1;
  bool operator==(const AttemptKey&) const = default;
  auto operator<=>(const AttemptKey&) const = default;
  static constexpr auto fields() {
    return std::tuple{field("run", &AttemptKey::run, 64), field("task", &AttemptKey::task, 64),
                      field("iteration", &AttemptKey::iteration), field("attempt", &AttemptKey::attempt)};
  }
};

/// Scheduler -> its mode-adapter (command). Answered by ExecutionState "running", or a Nack; the Outcome comes later.
struct Execute {
  static constexpr std::string_view kSubtype = "execute";
  AttemptKey key;
  std::uint32_t epoch = 1;
  std::uint64_t instance = 0;  ///< of the mode-adapter that is meant; another one refuses (stale_instance)
  std::string skill;
  std::string data;      ///< the skill's parameters, a JSON object
  double timeout_s = 0;  ///< 0: the description's
  static constexpr auto fields() {
    return std::tuple{field("key", &Execute::key),           field("epoch", &Execute::epoch),
                      field("instance", &Execute::instance), field("skill", &Execute::skill, 64),
                      field("data", &Execute::data, 65536),  field("timeout_s", &Execute::timeout_s)};
  }
};

/// Scheduler -> mode-adapter (command): stop this attempt's motion and report its outcome; does not fence.
struct CancelExecution {
  static constexpr std::string_view kSubtype = "cancel_execution";
  AttemptKey key;
  std::string reason;
  static constexpr auto fields() {
    return std::tuple{field("key", &CancelExecution::key), field("reason", &CancelExecution::reason, 255)};
  }
};

/// Scheduler -> mode-adapter (request): what became of it? Answered by ExecutionState or Outcome.
struct ExecutionQuery {
  static constexpr std::string_view kSubtype = "execution_query";
  AttemptKey key;
  static constexpr auto fields() { return std::tuple{field("key", &ExecutionQuery::key)}; }
};

/// `state` is "running", or "unknown": this instance was never given it.
struct ExecutionState {
  static constexpr std::string_view kSubtype = "execution_state";
  AttemptKey key;
  std::uint64_t instance = 0;
  std::string state;
  static constexpr auto fields() {
    return std::tuple{field("key", &ExecutionState::key), field("instance", &ExecutionState::instance),
                      field("state", &ExecutionState::state, 16)};
  }
};

/// Mode-adapter -> scheduler (information), again every second until OutcomeJournaled.
struct Outcome {
  static constexpr std::string_view kSubtype = "outcome";
  AttemptKey key;
  std::uint64_t instance = 0;
  TaskOutcome outcome{};
  std::string reason;  ///< why not finished, for a person
  std::string data;    ///< the result, JSON text or empty
  double duration_s = 0;
  static constexpr auto fields() {
    return std::tuple{field("key", &Outcome::key),          field("instance", &Outcome::instance),
                      field("outcome", &Outcome::outcome),  field("reason", &Outcome::reason, 1024),
                      field("data", &Outcome::data, 65536), field("duration_s", &Outcome::duration_s)};
  }
};

/// Scheduler -> mode-adapter: the outcome is on disk and may be forgotten.
struct OutcomeJournaled {
  static constexpr std::string_view kSubtype = "outcome_journaled";
  AttemptKey key;
  static constexpr auto fields() { return std::tuple{field("key", &OutcomeJournaled::key)}; }
};

/// Mode-adapter -> scheduler: at its start, at each change, and as answer to AdapterStateRequest. The paper's "ready".
struct AdapterState {
  static constexpr std::string_view kSubtype = "adapter_state";
  std::uint64_t instance = 0;
  std::string robot;  ///< as NodeProfile::robot
  bool fenced = false;
  bool busy = false;
  std::string control;  ///< who else holds the control lease, so that no skill begins; empty: nobody
  static constexpr auto fields() {
    return std::tuple{field("instance", &AdapterState::instance), field("robot", &AdapterState::robot, 32),
                      field("fenced", &AdapterState::fenced), field("busy", &AdapterState::busy),
                      field("control", &AdapterState::control, 64)};
  }
};

struct AdapterStateRequest {
  static constexpr std::string_view kSubtype = "adapter_state_request";
  static constexpr auto fields() { return std::tuple{}; }
};

/// Told to every node: the robot reports a fault of one capability.
struct RobotFault {
  static constexpr std::string_view kSubtype = "robot_fault";
  std::string capability;
  Severity severity{};
  std::string text;  ///< the robot's own words
  static constexpr auto fields() {
    return std::tuple{field("capability", &RobotFault::capability, 64), field("severity", &RobotFault::severity),
                      field("text", &RobotFault::text, 1024)};
  }
};

/// One value of a robot's: a name of its description's "sensors", and what it last was, as JSON text.
struct RobotValueTold {
  std::string name;
  std::string value;
  static constexpr auto fields() {
    return std::tuple{field("name", &RobotValueTold::name, 64), field("value", &RobotValueTold::value, 1024)};
  }
};

/// Told to every node: the sensors that the description names, at the first word of them and when one that is no list
/// has changed, once a second at most.
struct RobotState {
  static constexpr std::string_view kSubtype = "robot_state";
  std::vector<RobotValueTold> values;
  static constexpr auto fields() { return std::tuple{field("values", &RobotState::values, 32)}; }
};

/// To the node of a virtual robot (command): let it fail, as its maker's robot would. Answered by Ack "handed_over";
/// what comes of it the robot tells itself, by RobotFault. Refused by a robot that is not virtual (not_permitted).
struct InjectFault {
  static constexpr std::string_view kSubtype = "inject_fault";
  std::string capability;  ///< empty: everything that was injected is over
  Severity severity{};
  std::string text;  ///< the robot's own words
  static constexpr auto fields() {
    return std::tuple{field("capability", &InjectFault::capability, 64), field("severity", &InjectFault::severity),
                      field("text", &InjectFault::text, 1024)};
  }
};

/// Told to every node: the robot's connection changed.
struct RobotConnection {
  static constexpr std::string_view kSubtype = "robot_connection";
  std::string state;  ///< as NodeProfile::robot
  std::string detail;
  static constexpr auto fields() {
    return std::tuple{field("state", &RobotConnection::state, 32), field("detail", &RobotConnection::detail, 255)};
  }
};

/// Stops the robot and fences it until Release. From any member of the fleet. Answered by Ack "stopped".
/// Not a safety function (ISO 13850, ISO 10218).
struct Stop {
  static constexpr std::string_view kSubtype = "stop";
  std::string reason;
  static constexpr auto fields() { return std::tuple{field("reason", &Stop::reason, 255)}; }
};

/// Lifts the fence. Answered by Ack "released".
struct Release {
  static constexpr std::string_view kSubtype = "release";
  std::string reason;
  static constexpr auto fields() { return std::tuple{field("reason", &Release::reason, 255)}; }
};

}  // namespace trb
