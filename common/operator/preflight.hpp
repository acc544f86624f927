// A scenario before it runs: the check, and what the robots and sensors that it needs answer now.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/operator/plan_run.hpp"
#include "common/scenario/candidate_index.hpp"

namespace trb::op {

/// A robot that the run would begin with.
struct RobotPreflight {
  std::string robot;
  std::vector<std::string> tasks{};
  bool asked = false;              ///< it was sent a request: its node is reached, and it is connected
  bool answers = false;            ///< it has answered that request just now
  double answer_ms = 0;            ///< how long that took
  std::string value{};             ///< what it was asked for
  std::string answer{};            ///< as it was sent, or why it sends none
  std::vector<std::string> why{};  ///< it is not ready; empty: it is
};

/// The sensor of a task's condition.
struct SensorPreflight {
  std::string task;
  Condition condition;
  std::string node{};  ///< empty: no node has it
  std::optional<SensorReading> reading{};
  std::string why{};  ///< the condition cannot be evaluated now; empty: it can
};

struct Preflight {
  ConfigFaults faults{};
  std::vector<NoSpare> without_spare{};    ///< like the rest: if no fault stops the scenario
  std::vector<RobotPreflight> robots{};    ///< by id
  std::vector<SensorPreflight> sensors{};  ///< by task
  [[nodiscard]] bool is_ready() const;
};

/// Why a run would not begin on this robot now, by what its node has published.
std::vector<std::string> why_not_ready(const Route& route);

/// Plans the run, then asks all its robots that are connected, and its sensors, at once; silent ones are waited for 3
/// s. Errors: those of plan_run.
void preflight(Session& session, Scenario scenario, std::string file, const Callback<Preflight>& done);

}  // namespace trb::op
