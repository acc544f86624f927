// Checks of the names in commands.json that are the same for several transports.
#pragma once

#include <string>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/fleet/object_reader.hpp"

namespace trb::drivers {

/// The names of a part of commands.json, such as its values.
template <class Part>
std::vector<std::string> names_in(const Part& part) {
  std::vector<std::string> names;
  names.reserve(part.size());
  for (const auto& [name, ignored] : part) names.push_back(name);
  return names;
}

/// A fault of each request that names none of the `known` values.
void check_requests(const NodeConfig& config, const std::vector<std::string>& known, const FileFaults& faults);
/// A fault if the skill's command is not there, and the robot has no field channel, which would take it.
void check_command(const NodeConfig& config, const Skill& skill, const FileFaults& faults);

}  // namespace trb::drivers
