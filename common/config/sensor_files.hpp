// The rules of a node's sensors: NODE_DIR/sensors/*.json.
#pragma once

#include <string>
#include <vector>

#include "common/fleet/sensor_rule.hpp"

namespace trb {

/// In the order of the files' names, each with all of its faults. The folder is optional: without it there are no
/// rules.
std::vector<SensorRule> read_sensor_files(const std::string& node_dir, ConfigFaults& faults);

}  // namespace trb
