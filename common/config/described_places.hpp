// Checks that the places which a robot's skills name are known: to its description, or to the hall.
#pragma once

#include <string>

#include "common/base/config_fault.hpp"
#include "common/fleet/description.hpp"

namespace trb {

/// The places that a skill's parameter names (one_of, default), which a run could only be refused for. The faults are
/// of `file`, the description's. `hall`: the places of `hall_file`.
void check_described_places(const Description& description, const Places& hall, const std::string& file,
                            const std::string& hall_file, ConfigFaults& faults);

}  // namespace trb
