// The parsed content of commands.json for a robot with a REST interface.
#pragma once

#include "common/drivers/http-json/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct HttpCommands {
  std::map<std::string, std::vector<HttpCall>, std::less<>> commands;  ///< by subtype
  std::map<std::string, HttpQuestion, std::less<>> values;             ///< by name
  std::optional<HttpCall> sign_out;                                    ///< sent as the node ends
};

/// Checks that stop, release and the sign-out need no data, and that some command's answer provides what a path needs.
/// What cannot be parsed is left out.
HttpCommands read_http_commands(const VendorCommands& vendor, const Description& description,
                                const VendorFaults& faults);

}  // namespace trb::drivers
