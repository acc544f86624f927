// The parsed content of commands.json for a drone.
#pragma once

#include <map>

#include "common/drivers/udp-at/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

using AtCommands = std::map<std::string, std::vector<AtLine>, std::less<>>;  ///< by subtype

/// Checks that a stop lands the drone or makes it hover, and that a release does nothing. What cannot be parsed is left
/// out.
AtCommands read_at_commands(const VendorCommands& vendor, const Description& description, const VendorFaults& faults);

}  // namespace trb::drivers
