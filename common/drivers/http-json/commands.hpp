// What commands.json says for a robot with a REST interface, read.
#pragma once

#include "common/drivers/http-json/syntax.hpp"
#include "common/drivers/vendor_faults.hpp"

namespace trb::drivers {

struct HttpCommands {
  std::map<std::string, std::vector<HttpWords>, std::less<>> commands;  ///< by subtype
  std::map<std::string, HttpQuestion, std::less<>> values;              ///< by name
};

/// Stop and release need no data, and what a path needs is told by some command's answer. What cannot be read is left
/// out.
HttpCommands read_http_commands(const VendorCommands& vendor, const Description& description,
                                const VendorFaults& faults);

}  // namespace trb::drivers
