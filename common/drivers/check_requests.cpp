#include "common/drivers/check_requests.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {

void check_requests(const NodeConfig& config, const std::vector<std::string>& known, const FileFaults& faults,
                    std::string_view otherwise) {
  const std::string path = config.framework + ".requests.";
  for (const auto& [subtype, value] : config.commands.requests) {
    if (std::ranges::find(known, value) != known.end()) continue;
    faults.add(path + subtype, in_quotes(value) + " is not one of the values", did_you_mean(value, known, otherwise));
  }
}

}  // namespace trb::drivers
