// The job of a simulation in a request's body: what trb-simulator takes, within the gateway's bounds.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"
#include "proto/value.hpp"

namespace trb::gateway {

constexpr std::size_t kMaxSimulationJob = 32U << 10U;
/// Of the real cores: with more of them no simulation ends within its minute.
constexpr std::int64_t kMaxSimulatedRobots = 100;
constexpr std::int64_t kMaxSimulatedTasks = 1000;
constexpr std::size_t kMaxSimulatedFaults = 100;

/// Every fault is added, by its key. What depends on several of the job's numbers is the simulator's to refuse.
void check_simulation_job(const Value& job, ConfigFaults& faults);

/// "paper, 5 robots, 9 tasks", of a job that has passed: for the audit log.
std::string simulation_in_words(const Value& job);

}  // namespace trb::gateway
