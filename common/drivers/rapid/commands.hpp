// The parsed content of commands.json for an ABB.
#pragma once

#include <map>

#include "common/drivers/rapid/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct RapidCommands {
  std::map<std::string, std::vector<RapidRequest>, std::less<>> commands;  ///< by subtype
  std::map<std::string, RapidQuestion, std::less<>> values;                ///< by name
};

/// Checks that only stop and release go to the service task. Faulty entries are left out.
RapidCommands read_rapid_commands(const VendorCommands& vendor, const Description& description,
                                  const VendorFaults& faults);

}  // namespace trb::drivers
