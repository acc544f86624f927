// A robot's text about a fault, where the program on it can say more than its controller.
#pragma once

#include <string>
#include <vector>

#include "services/mode-adapter/core/modes/mode.hpp"

namespace trb::adapter {

/// "CAPABILITY SEVERITY TEXT"; any other text is a critical fault of all that the robot can do.
FaultSaid read_fault_text(std::string_view text, const std::vector<std::string>& capabilities, std::string cause);

}  // namespace trb::adapter
