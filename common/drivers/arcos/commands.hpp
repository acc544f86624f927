// The parsed content of commands.json for a Pioneer.
#pragma once

#include <map>

#include "common/drivers/arcos/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct ArcosCommands {
  std::map<std::string, std::vector<ArcosStep>, std::less<>> commands;  ///< by subtype
  std::map<std::string, std::vector<ArcosField>, std::less<>> values;   ///< by name
};

/// Checks that a stop command stops the robot. What cannot be parsed is left out.
ArcosCommands read_arcos_commands(const VendorCommands& vendor, const Description& description,
                                  const VendorFaults& faults);

}  // namespace trb::drivers
