// Checks one robot's description and its commands without a node: for `trb robot check`.
#pragma once

#include <string>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/config/transports.hpp"

namespace trb {

/// Which files. One that is not named is looked for beside the description, then in the folder above; if there is none,
/// what depends on it is not checked.
struct RobotFiles {
  std::string description;
  std::string profile;
  std::string commands;
  std::string places;
  std::string
      framework;  ///< whose commands are used; empty: of the node that has it as its description, else any that fit
};

/// A framework whose commands fit the description.
struct SpokenTo {
  std::string framework;
  Mode mode{};
  std::string transport;
};

struct RobotCheck {
  ConfigFaults faults;
  Description description;
  Places places;
  std::vector<SpokenTo> spoken_to;
  std::vector<std::string> absent;  ///< "places.json": not found, so not checked
};
RobotCheck check_robot_files(const RobotFiles& files, const Transports& known);

}  // namespace trb
