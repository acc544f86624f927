// The check of "requests" in commands.json that is the same for several transports.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb::drivers {

/// A fault of each request that names none of the `known` values. `otherwise`: the cure, which the known ones follow.
void check_requests(const NodeConfig& config, const std::vector<std::string>& known, const FileFaults& faults,
                    std::string_view otherwise = "add it to \"values\", or use one of");

}  // namespace trb::drivers
