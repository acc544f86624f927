// What commands.json says for a Pioneer, read.
#pragma once

#include <map>

#include "common/drivers/arcos/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct ArcosCommands {
  std::map<std::string, std::vector<ArcosStep>, std::less<>> commands;  ///< by subtype
  std::map<std::string, std::vector<ArcosField>, std::less<>> values;   ///< by name
};

/// A stop stops. What cannot be read is left out.
ArcosCommands read_arcos_commands(const VendorCommands& vendor, const Description& description,
                                  const VendorFaults& faults);

}  // namespace trb::drivers
