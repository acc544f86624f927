// One robot's description and what it is spoken to with, checked without a node: for `trb robot check`.
#pragma once

#include <string>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/config/transports.hpp"

namespace trb {

/// Which files. One that is not named is looked for beside the description, then in the folder above; without any, what
/// it would have told is not checked.
struct RobotFiles {
  std::string description;
  std::string profile;
  std::string commands;
  std::string places;
  std::string framework;  ///< whose words are meant; empty: any that fit
};

/// A framework whose words fit the description.
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
