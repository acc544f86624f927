// A task's `data` as a scenario file has it.
#pragma once

#include <string>
#include <vector>

#include "common/fleet/object_reader.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// Reads `data` of a task: each parameter's value, or {"from": "TASK", "value": "NAME"}, which becomes one of `values`
/// and is left out of the data. The caller, who knows the other tasks, checks that TASK comes before.
void read_data(ObjectReader& reader, Task& task);

}  // namespace trb
