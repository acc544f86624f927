// Poses in URScript that no arm of that length can take: known before anything is sent.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/drivers/tcp-text/ur_monitor.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb::drivers {

/// The places x y z of the poses p[x, y, z, …] in a script, as far as they are written as numbers.
std::vector<std::array<double, 3>> poses_in(std::string_view script);

/// Of a script that is about to be sent. Error: bad_value, naming the pose. A script that sets another tool itself is
/// not judged.
std::optional<Error> out_of_reach(std::string_view script, const std::optional<UrReach>& reach);

/// The poses in the vendor's commands, and those that the description's skills fill in, against the description's
/// number "reach" (m).
void check_reach(const NodeConfig& config, const FileFaults& faults);

}  // namespace trb::drivers
