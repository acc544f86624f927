// Conditions of tasks as a scenario file has them, and what the fleet makes of them.
#pragma once

#include <map>
#include <string>

#include "common/fleet/object_reader.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// Reads a task's `when`: {"sensor", "of", "identity", "op", "value", "unit"}; `path` is where it stands in the file.
/// Another kind of condition would be known by another key in place of `sensor`.
Condition read_condition(const Value& json, const std::string& path, const FileFaults& faults);

/// Checks a condition against what the nodes say of themselves: a node that is none of the fleet's, a sensor of another
/// unit. That no node has such a sensor now may wait, for it may be plugged in later.
void check_condition(const Condition& condition, const std::map<std::string, NodeProfile>& profiles,
                     const std::string& path, const std::string& file, ConfigFaults& faults);

}  // namespace trb
