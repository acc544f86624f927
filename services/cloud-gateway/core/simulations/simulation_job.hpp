// The job of a simulation in a request's body: what trb-simulator takes, within the gateway's bounds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/base/config_fault.hpp"
#include "proto/bodies/run.hpp"
#include "proto/value.hpp"

namespace trb::gateway {

constexpr std::size_t kMaxSimulationJob = 32U << 10U;
constexpr std::size_t kMaxScenarioJob = 256U << 10U;  ///< with a scenario: as much as a stored one
/// Of the real cores: with more of them no simulation ends within its minute.
constexpr std::int64_t kMaxSimulatedRobots = 100;
constexpr std::int64_t kMaxSimulatedTasks = 1000;
constexpr std::size_t kMaxSimulatedFaults = 100;

/// A job that has passed its check.
struct SimulationJob {
  std::string text;     ///< as it was asked for, JSON
  std::string outline;  ///< the same without its scenario, for lists
  std::string input;    ///< of trb-simulator
  std::int64_t robots = 0;
  std::int64_t tasks = 0;
  std::optional<Scenario> scenario{};  ///< nullopt: tasks of no scenario
};

/// Every fault is added, by its key. What depends on several of the job's numbers is the simulator's to refuse; what a
/// `scenario` says is scenario_job()'s to check.
void check_simulation_job(const Value& job, ConfigFaults& faults);

/// Of a job that has passed, without a scenario.
SimulationJob counted_job(const Value& job);

/// "paper, 5 robots, 9 tasks"; "scenario 'NAME', 5 robots, 9 tasks": for the audit log.
std::string simulation_in_words(const SimulationJob& job);

}  // namespace trb::gateway
