// The folders of a fleet's nodes, as `trb fleet` and `trb check` know them, read without any node running.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/base/config_fault.hpp"
#include "common/fleet/sensor_rule.hpp"
#include "proto/bodies/link.hpp"

namespace trb::cli {

/// The rules of the sensors that may be plugged in, by node id; a cloud node's are those of "cloud", as a simulation
/// calls it.
using FolderSensors = std::map<std::string, std::vector<SensorRule>>;

/// What the robots' nodes would tell the fleet of them (capabilities, skills, places, the robots' own values), by node
/// id: of each folder in `dir` that has a node.json and a robot; and these nodes' rules. Faults: of the folders,
/// two with one id (naming both), and if there is no robot.
std::map<std::string, NodeProfile> read_fleet_folders(const std::string& dir, ConfigFaults& faults,
                                                      FolderSensors* sensors = nullptr);

}  // namespace trb::cli
