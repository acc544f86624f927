// Scenario files: JSON in, a checked Scenario out.
#pragma once

#include <map>
#include <string>

#include "common/base/config_fault.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run.hpp"
#include "proto/value.hpp"

namespace trb {

/// Reads a scenario file (config/scenarios/README.md has every key). Every fault at once: cycles (naming the tasks on
/// it), duplicate ids, unknown predecessors, values of tasks that do not come before, wrong types, unknown keys. Task
/// order is kept: a task's index is its place in the file; the rounds of a repeated scenario stand one behind the
/// other. Without faults the scenario passes check_graph.
Scenario read_scenario(const Value& json, const std::string& file, ConfigFaults& faults);

/// More warnings tell nothing new.
constexpr std::size_t kMaxWarnings = 200;

/// Warnings, as what may wait: a task that is skipped when it fails, and what would be SKIPPED with it.
void warn_of_skips(const Scenario& scenario, const std::string& file, ConfigFaults& faults);

/// Checks a scenario against what the nodes say of themselves (profiles by node id): unknown robots, skills and places;
/// parameters that are missing, unknown or of the wrong type;
/// conditions on nodes that are unknown or in another unit, and, as what may wait, on sensors that are not plugged in.
void check_scenario(const Scenario& scenario, const std::map<std::string, NodeProfile>& profiles,
                    const std::string& file, ConfigFaults& faults);

}  // namespace trb
