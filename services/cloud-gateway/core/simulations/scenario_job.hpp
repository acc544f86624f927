// A simulation of a scenario with the fleet's own robots: its check, its job, and what its tasks waited for.
#pragma once

#include <map>
#include <string>

#include "common/base/bytes.hpp"
#include "proto/bodies/link.hpp"
#include "services/cloud-gateway/core/simulations/simulation_job.hpp"

namespace trb::gateway {

/// The nodes' profiles by id, as the gateway knows them. A robot's is one of a node with a robot.
using KnownNodes = std::map<std::string, NodeProfile>;

/// Those with a robot.
KnownNodes robots_of(const KnownNodes& nodes);

/// Of a job that has passed check_simulation_job, with a `scenario`: what trb-simulator is to play. The scenario is
/// checked as that program checks it: with the robots, a cloud named "cloud", and the job's sensors and times; its own
/// faults' keys begin with "scenario".
SimulationJob scenario_job(const Value& job, const KnownNodes& nodes, ConfigFaults& faults);

/// The simulator's answer, and in it `waits`: what each task of the scenario waited for, and the critical path.
Bytes with_waits(Bytes answer, const Scenario& scenario);

}  // namespace trb::gateway
