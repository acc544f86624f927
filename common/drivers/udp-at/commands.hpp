// What commands.json says for a drone, read.
#pragma once

#include <map>

#include "common/drivers/udp-at/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

using AtCommands = std::map<std::string, std::vector<AtLine>, std::less<>>;  ///< by subtype

/// A stop lands the drone or lets it stand in the air, a release does nothing. What cannot be read is left out.
AtCommands read_at_commands(const VendorCommands& vendor, const Description& description, const VendorFaults& faults);

}  // namespace trb::drivers
