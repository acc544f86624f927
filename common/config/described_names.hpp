// Checks that commands.json has what a robot's description names: the values that it watches, the commands of its
// drives and of its skills.
#pragma once

#include <string>
#include <string_view>

#include "common/base/config_fault.hpp"
#include "common/config/node_config.hpp"
#include "common/config/transports.hpp"

namespace trb {

/// Values (faults, sensors) and drives, for every transport that names them in commands.json. The faults are of `file`,
/// the description's.
void check_described_names(const NodeConfig& config, const Transports& known, const std::string& file,
                           ConfigFaults& faults);

/// A skill: for the checks of the transports, as each knows whether its skills need a command. A fault of commands.json
/// if the skill's command is not there, and the robot has no field channel, which would take it. True: it is there.
/// `example`: a command of that transport, for the hint; without one the hint names the commands that are there.
bool check_skill_command(const NodeConfig& config, const Skill& skill, const FileFaults& faults,
                         std::string_view example = {});

}  // namespace trb
