// Conditions of tasks as a scenario file has them, and their check against the fleet.
#pragma once

#include <map>
#include <string>

#include "common/fleet/object_reader.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/run.hpp"

namespace trb {

/// Reads a task's `when`: {"sensor", "of", "identity", "op", "value", "unit"}; `path` is its place in the file. Another
/// kind of condition would have another key instead of `sensor`.
Condition read_condition(const Value& json, const std::string& path, const FileFaults& faults);

/// Checks a condition against the nodes' profiles: a node that is not in the fleet, a sensor with another unit, a text
/// that is compared with numbers. That no node has such a sensor now, or that its unit is not known yet, is only a
/// warning: it may be plugged in later, and read.
void check_condition(const Condition& condition, const std::map<std::string, NodeProfile>& profiles,
                     const std::string& path, const std::string& file, ConfigFaults& faults);

}  // namespace trb
