// The job of a simulation in a request's body: what trb-simulator takes, within the gateway's bounds.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/base/config_fault.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run.hpp"
#include "proto/value.hpp"

namespace trb::gateway {

constexpr std::size_t kMaxSimulationJob = 256U << 10U;  ///< as much as a stored scenario
/// Of the real cores: with more of them no simulation ends within its minute.
constexpr std::int64_t kMaxSimulatedRobots = 100;
constexpr std::int64_t kMaxSimulatedTasks = 1000;
constexpr std::size_t kMaxSimulatedFaults = 100;
constexpr std::size_t kMaxSimulatedSensors = 100;

/// A job that has passed its check.
struct SimulationJob {
  std::string text;     ///< as it was asked for, JSON
  std::string outline;  ///< the same without what may be long, for lists
  std::string input;    ///< of trb-simulator
  std::int64_t robots = 0;
  std::int64_t tasks = 0;
  std::vector<Scenario> scenarios{};  ///< the job's own, then those beside it; empty: tasks of no scenario
};

/// Every fault is added, by its key. What goes wrong, the network and the sensors are read as `trb simulate` reads its
/// files (common/simulation); no key names a file. `robots`: the fleet's, by whose ids a scenario's faults and sensors
/// go. What a `scenario` says is scenario_job()'s to check.
void check_simulation_job(const Value& job, const std::map<std::string, NodeProfile>& robots, ConfigFaults& faults);

/// Of a job that has passed: without its scenarios, sensor_values, times, measured delays and the nodes of partitions.
std::string simulation_outline(const Value& job);

/// Of a job that has passed, without a scenario.
SimulationJob counted_job(const Value& job);

/// "paper, 5 robots, 9 tasks"; "scenario 'NAME', 5 robots, 9 tasks"; "scenario 'NAME' and 2 beside it, ...": for the
/// audit log.
std::string simulation_in_words(const SimulationJob& job);

}  // namespace trb::gateway
