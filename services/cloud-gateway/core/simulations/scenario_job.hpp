// A simulation of a scenario with the fleet's own robots: its check, its job, and what its tasks waited for.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "proto/bodies/link.hpp"
#include "services/cloud-gateway/core/simulations/simulation_job.hpp"

namespace trb::gateway {

/// The nodes' profiles by id, as the gateway knows them. A robot's is one of a node with a robot.
using KnownNodes = std::map<std::string, NodeProfile>;

/// Those with a robot.
KnownNodes robots_of(const KnownNodes& nodes);

/// Of a job that has passed check_simulation_job, with a `scenario`: what trb-simulator is to play. Its scenarios
/// are checked as that program checks them: with the robots, a cloud named "cloud", and the job's sensors and times;
/// the faults' keys begin with "scenario" or "beside[0].scenario". With others beside it each is played alone, too.
SimulationJob scenario_job(const Value& job, const KnownNodes& nodes, ConfigFaults& faults);

/// The simulator's answer, and in it `waits`: what each task of the scenario waited for, and the critical path; so in
/// each of its `beside`.
Bytes with_waits(Bytes answer, const std::vector<Scenario>& scenarios);

}  // namespace trb::gateway
