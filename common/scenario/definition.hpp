// Scenario files: JSON in, a checked Scenario out.
#pragma once

#include <map>
#include <string>

#include "common/base/config_fault.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run.hpp"
#include "proto/value.hpp"

namespace trb {

/// Reads a scenario file (config/scenarios/README.md has every key). Reports every fault at once: cycles (naming the
/// tasks on it), duplicate ids, unknown predecessors, values of tasks that do not come before, wrong types, unknown
/// keys. The order is kept: a task's index is its place in the file; a repeated scenario's rounds follow each other. A
/// scenario without faults passes check_graph.
Scenario read_scenario(const Value& json, const std::string& file, ConfigFaults& faults);

/// No more warnings are kept: they would tell nothing new.
constexpr std::size_t kMaxWarnings = 200;

/// Warnings: each task that is skipped when it fails, and what would be SKIPPED with it.
void warn_of_skips(const Scenario& scenario, const std::string& file, ConfigFaults& faults);

/// Checks a scenario against the nodes' profiles (by node id): unknown robots, skills and places; parameters that are
/// missing, unknown or of the wrong type; conditions on unknown nodes or in another unit, and, as warnings, conditions
/// on sensors that are not plugged in. A task of which `faults` has a fault already is left out, unless it is one of
/// its `after`.
void check_scenario(const Scenario& scenario, const std::map<std::string, NodeProfile>& profiles,
                    const std::string& file, ConfigFaults& faults);

}  // namespace trb
