// What a Universal Robot's monitor tells, and the check of the names that commands.json and the description use of it.
#pragma once

#include <string>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb::drivers {

/// The names of the monitor's values, in their usual order.
const std::vector<std::string>& ur_monitored_values();

/// Faults of requests and of skills' ends that name nothing that the monitor tells: nothing would ever come. Without a
/// monitor check_tcp_text says so.
void check_monitored_names(const NodeConfig& config, const FileFaults& faults);

}  // namespace trb::drivers
