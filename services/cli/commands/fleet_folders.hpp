// The folders of a fleet's nodes, as `trb fleet` and `trb check` know them, read without any node running.
#pragma once

#include <map>
#include <string>

#include "common/base/config_fault.hpp"
#include "proto/bodies/link.hpp"

namespace trb::cli {

/// What the robots' nodes would tell the fleet of them (capabilities, skills, places), by node id: of each folder in
/// `dir` that has a node.json and a robot. Faults: of the folders, and if there is no robot.
std::map<std::string, NodeProfile> read_fleet_folders(const std::string& dir, ConfigFaults& faults);

}  // namespace trb::cli
