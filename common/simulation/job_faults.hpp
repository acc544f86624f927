// What goes wrong in a simulated fleet, as a job says it.
#pragma once

#include <string>
#include <vector>

#include "common/fleet/object_reader.hpp"
#include "common/simulation/fault.hpp"
#include "common/simulation/job_nodes.hpp"

namespace trb::simulation {

constexpr std::size_t kMaxFaults = 1000;

/// Key `faults`, optional: a list of {"at", "kind", ...}, `most` at most; services/simulator/README.md has each kind's
/// keys. `at` counts from the run's submission; a cut, partition, clock, disk or battery without it is so from the
/// world's start. Every fault of the job is added, by its key.
std::vector<Fault> read_faults(ObjectReader& reader, const JobNodes& nodes, std::size_t most = kMaxFaults);

/// Key `relays`, optional: the nodes that relay.
std::vector<std::string> read_relays(ObjectReader& reader, const JobNodes& nodes);

}  // namespace trb::simulation
