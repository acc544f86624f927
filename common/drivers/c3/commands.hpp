// The parsed content of commands.json for a KUKA.
#pragma once

#include "common/drivers/c3/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct C3Commands {
  C3Names names;
  std::map<std::string, std::vector<C3Assignment>, std::less<>> commands;  ///< by subtype
  std::map<std::string, C3Question, std::less<>> values;                   ///< by name, without those of the hand-shake
};

/// Faulty entries are left out.
C3Commands read_c3_commands(const VendorCommands& vendor, const Description& description, const VendorFaults& faults);

}  // namespace trb::drivers
